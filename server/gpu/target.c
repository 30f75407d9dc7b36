/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Creates framebuffers with a colour buffer and a depth buffer, to draw frames into. */
#include "gpu/target.h"

#include "gpu/gl.h"

static bool make(GLuint *framebuffer, GLuint *color, GLuint *depth, int width_px, int height_px, int samples)
{
    gl_clear_errors();
    GLenum kind = samples > 1 ? GL_TEXTURE_2D_MULTISAMPLE : GL_TEXTURE_2D;
    glCreateTextures(kind, 1, color);
    glCreateTextures(kind, 1, depth);
    if (samples > 1) {
        glTextureStorage2DMultisample(*color, samples, GL_RGBA8, width_px, height_px, GL_TRUE);
        glTextureStorage2DMultisample(*depth, samples, GL_DEPTH_COMPONENT32F, width_px, height_px, GL_TRUE);
    } else {
        glTextureStorage2D(*color, 1, GL_RGBA8, width_px, height_px);
        glTextureStorage2D(*depth, 1, GL_DEPTH_COMPONENT32F, width_px, height_px);
        glTextureParameteri(*color, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        glTextureParameteri(*depth, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        glTextureParameteri(*depth, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    }
    glCreateFramebuffers(1, framebuffer);
    glNamedFramebufferTexture(*framebuffer, GL_COLOR_ATTACHMENT0, *color, 0);
    glNamedFramebufferTexture(*framebuffer, GL_DEPTH_ATTACHMENT, *depth, 0);
    return glCheckNamedFramebufferStatus(*framebuffer, GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE && gl_no_errors();
}

bool target_init(struct target *target, struct log *log, int width_px, int height_px, int samples)
{
    *target = (struct target){ .width_px = width_px, .height_px = height_px, .samples = samples };
    bool good = make(&target->framebuffer, &target->color, &target->depth, width_px, height_px, samples);
    if (good && samples > 1) {
        good = make(&target->resolved_framebuffer, &target->resolved_color, &target->resolved_depth, width_px, height_px, 1);
    } else {
        target->resolved_framebuffer = target->framebuffer;
        target->resolved_color = target->color;
        target->resolved_depth = target->depth;
    }
    glCreateFramebuffers(1, &target->over_framebuffer);
    glNamedFramebufferTexture(target->over_framebuffer, GL_COLOR_ATTACHMENT0, target->resolved_color, 0);
    if (good)
        return true;
    log_err(log, "cannot allocate a picture of %dx%d with %d samples per pixel: out of GPU memory", width_px, height_px, samples);
    gl_clear_errors();
    target_finish(target);
    return false;
}

size_t target_bytes(const struct target *target)
{
    size_t pixels = (size_t)target->width_px * (size_t)target->height_px, samples = (size_t)target->samples;
    /* bytes of colour and depth of all samples, plus those of the resolved copies if the target is multisampled */
    return 8 * pixels * (samples > 1 ? samples + 1 : 1);
}

void target_finish(struct target *target)
{
    GLuint textures[] = { target->color, target->depth, target->resolved_color, target->resolved_depth };
    GLuint framebuffers[] = { target->framebuffer, target->resolved_framebuffer };
    int count = target->samples > 1 ? 2 : 1;
    glDeleteFramebuffers(1, &target->over_framebuffer);
    glDeleteFramebuffers(count, framebuffers);
    glDeleteTextures(2 * count, textures);
    *target = (struct target){ 0 };
}

void target_resolve(const struct target *target, int x_px, int y_px, int width_px, int height_px)
{
    int right_px = x_px + width_px, bottom_px = y_px + height_px;
    if (target->samples > 1)
        glBlitNamedFramebuffer(target->framebuffer, target->resolved_framebuffer, x_px, y_px, right_px, bottom_px, x_px, y_px, right_px,
                               bottom_px, GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT, GL_NEAREST);
}

bool render_texture_fit(struct render_texture *layer, GLenum format, GLenum attachment, int width_px, int height_px)
{
    if (layer->texture && layer->width_px == width_px && layer->height_px == height_px)
        return true;
    render_texture_finish(layer);
    *layer = (struct render_texture){ .width_px = width_px, .height_px = height_px };
    gl_clear_errors();
    glCreateTextures(GL_TEXTURE_2D, 1, &layer->texture);
    glTextureStorage2D(layer->texture, 1, format, width_px, height_px);
    glTextureParameteri(layer->texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glCreateFramebuffers(1, &layer->framebuffer);
    glNamedFramebufferTexture(layer->framebuffer, attachment, layer->texture, 0);
    if (attachment == GL_DEPTH_ATTACHMENT)
        glNamedFramebufferDrawBuffer(layer->framebuffer, GL_NONE);
    if (gl_no_errors())
        return true;
    render_texture_finish(layer);
    return false;
}

void render_texture_finish(struct render_texture *layer)
{
    glDeleteFramebuffers(1, &layer->framebuffer);
    glDeleteTextures(1, &layer->texture);
    *layer = (struct render_texture){ 0 };
}
