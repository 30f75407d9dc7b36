/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of the GL render backend, which draws whole frames on a GPU and tile by tile on a processor. Call only in the thread
   that owns the GL context. */
#ifndef RENDER_GL_BACKEND_H
#define RENDER_GL_BACKEND_H
#include "render/gl/frames_in_flight.h"
#include "render/gl/ghosts.h"
#include "render/gl/lines.h"
#include "render/gl/section_caps.h"
#include "render/gl/surface_pass.h"
#include "render/gl/targets.h"
#include "render/render_backend.h"

/* passes in which a frame is drawn tile by tile (a tile is a rectangle of the frame): surfaces, then edges */
enum gl_pass { GL_SURFACES, GL_EDGES, GL_PASSES };

struct gl_backend {
    struct surface_pass surface_pass;
    struct gl_lines lines;
    struct ghosts ghosts;
    struct section_caps section_caps;
    struct frames_in_flight frames_in_flight;
    GLuint frame_buffer; /* uniform buffer of struct frame_uniforms */
    struct targets targets;
    double pixel_ns[GL_PASSES]; /* last measured drawing time per pixel in nanoseconds, by pass (enum gl_pass) */
    int64_t refined_ns;         /* GPU time in nanoseconds that the last refined frame took; 0: unknown */
};

/* Binds the light set (baked light), the colour map and the uniforms of a frame in GL. Call it again before continuing the
   frame after other frames were drawn. Logs and returns false when out of GPU memory. */
bool gl_backend_take_up(struct renderer *renderer, struct frame_context *context);

#endif
