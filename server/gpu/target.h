/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An offscreen render target with 8-bit colour and 32-bit depth, with or without multisampling. Call only in the thread that owns
   the GL context. */
#ifndef GPU_TARGET_H
#define GPU_TARGET_H
#include <stdbool.h>

#include <glad/gl.h>

#include <stddef.h>

#include "base/log/log.h"

struct target {
    int width_px, height_px, samples;
    GLuint framebuffer, color, depth; /* framebuffer that render passes draw to, and its textures for colour and depth */
    /* framebuffer of the resolved picture (one sample per pixel), and its textures; the same objects as framebuffer, color and
       depth if `samples` is 1 */
    GLuint resolved_framebuffer, resolved_color, resolved_depth;
    GLuint over_framebuffer; /* framebuffer with the resolved colour but no depth, for drawing over the picture while shaders read its
                                depth */
};

size_t target_bytes(const struct target *target); /* returns the size in bytes of the target's textures; 0 for an empty target */
/* Creates framebuffers and textures. Logs and returns false when out of GPU memory. */
bool target_init(struct target *target, struct log *log, int width_px, int height_px, int samples);
void target_finish(struct target *target);
/* Resolves a rectangle of a multisampled target: averages the colours of the samples, and takes the depth of one sample. No-op
   without multisampling. */
void target_resolve(const struct target *target, int x_px, int y_px, int width_px, int height_px);

/* A texture to draw to, with the size of the frame. Zero-initialise. */
struct render_texture {
    int width_px, height_px;
    GLuint framebuffer, texture;
};
/* Creates the texture, and a framebuffer that has it as `attachment`, if there is none or its size differs; its contents are
   then lost. Format and attachment must be those of the first call. Returns false when out of GPU memory (not logged), and
   leaves the texture empty; the next call tries again. */
bool render_texture_fit(struct render_texture *layer, GLenum format, GLenum attachment, int width_px, int height_px);
void render_texture_finish(struct render_texture *layer);

#endif
