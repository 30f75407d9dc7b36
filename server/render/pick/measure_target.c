/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A framebuffer with four floats per pixel, and reading it back. */
#include "render/pick/measure_target.h"


bool measure_target_begin(struct measure_target *measure, struct log *log, int width_px, int height_px)
{
    static const float nothing[4] = { 0, MEASURE_NOTHING, 0, 0 };
    static const float far = 0;
    *measure = (struct measure_target){ .width_px = width_px, .height_px = height_px };
    while (glGetError() != GL_NO_ERROR) {
    }
    glCreateTextures(GL_TEXTURE_2D, 1, &measure->numbers);
    glCreateTextures(GL_TEXTURE_2D, 1, &measure->depth);
    glTextureStorage2D(measure->numbers, 1, GL_RGBA32F, width_px, height_px);
    glTextureStorage2D(measure->depth, 1, GL_DEPTH_COMPONENT32F, width_px, height_px);
    glCreateFramebuffers(1, &measure->framebuffer);
    glNamedFramebufferTexture(measure->framebuffer, GL_COLOR_ATTACHMENT0, measure->numbers, 0);
    glNamedFramebufferTexture(measure->framebuffer, GL_DEPTH_ATTACHMENT, measure->depth, 0);
    if (glGetError() != GL_NO_ERROR ||
        glCheckNamedFramebufferStatus(measure->framebuffer, GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
        log_err(log, "numbers of %dx%d pixels: out of GPU memory", width_px, height_px);
        return false;
    }
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, measure->framebuffer);
    glDepthMask(GL_TRUE);
    glClearNamedFramebufferfv(measure->framebuffer, GL_COLOR, 0, nothing);
    glClearNamedFramebufferfv(measure->framebuffer, GL_DEPTH, 0, &far);
    return true;
}

void measure_target_read(const struct measure_target *measure, float (*out)[4])
{
    glBindFramebuffer(GL_READ_FRAMEBUFFER, measure->framebuffer);
    glReadPixels(0, 0, measure->width_px, measure->height_px, GL_RGBA, GL_FLOAT, out);
}

void measure_target_finish(struct measure_target *measure)
{
    glDeleteFramebuffers(1, &measure->framebuffer);
    glDeleteTextures(1, &measure->numbers);
    glDeleteTextures(1, &measure->depth);
    *measure = (struct measure_target){ 0 };
}
