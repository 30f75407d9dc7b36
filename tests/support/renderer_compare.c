/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws the field's values with GL into a framebuffer of four floats per pixel, so that tests can compare numbers instead of
   colours. Also changes settings of the GL backend. */
#include "tests/support/renderer_compare.h"

#include <limits.h>

#include <glad/gl.h>

#include "render/gl/gl_backend.h"
#include "render/renderer_impl.h"

struct measure_target {
    int width_px, height_px;
    GLuint framebuffer, numbers, depth;
};

/* Creates the framebuffer, binds it and sets all pixels to MEASURE_NOTHING. Logs and returns false if the GPU is out of memory.
   Call measure_target_finish() in both cases. */
static bool measure_target_begin(struct measure_target *measure, struct log *log, int width_px, int height_px)
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

static void measure_target_read(const struct measure_target *measure, float (*out)[4])
{
    glBindFramebuffer(GL_READ_FRAMEBUFFER, measure->framebuffer);
    glReadPixels(0, 0, measure->width_px, measure->height_px, GL_RGBA, GL_FLOAT, out);
}

static void measure_target_finish(struct measure_target *measure)
{
    glDeleteFramebuffers(1, &measure->framebuffer);
    glDeleteTextures(1, &measure->numbers);
    glDeleteTextures(1, &measure->depth);
    *measure = (struct measure_target){ 0 };
}

bool renderer_measure(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot, bool finest, float (*out)[4])
{
    struct frame_planner planner = renderer->planner;
    struct view plain = *view;
    struct frame_context context;
    struct measure_target measure = { 0 };
    plain.color_scale.log = false;
    planner.finest = finest;
    struct frame_plan *plan = frame_plan_create(&planner, &plain);
    frame_plan_complete(plan, &planner, snapshot);
    fields_upload(&renderer->fields, plan->visible, plan->visible_count, plan->fields);
    renderer_init_context(renderer, plan, &context);
    context.measured = true;
    bool good = render_backend_gl.init(renderer) && gl_backend_take_up(renderer, &context) &&
                measure_target_begin(&measure, renderer->gl->log, view->width_px, view->height_px);
    if (good) {
        surface_pass_prepare(&renderer->by_gl->surface_pass, &renderer->fields, &context);
        surface_pass_draw_some(&renderer->by_gl->surface_pass, &context, 0, INT_MAX);
        surface_pass_draw_blended(&renderer->by_gl->surface_pass, &context);
        measure_target_read(&measure, out);
    }
    measure_target_finish(&measure);
    frame_plan_destroy(&plan);
    return good;
}

void renderer_set_occlusion_least(struct renderer *renderer, int least_triangles)
{
    renderer->by_gl->surface_pass.least_hiding = least_triangles;
}

void renderer_set_batching_off(struct renderer *renderer, bool one_by_one)
{
    renderer->by_gl->surface_pass.one_by_one = one_by_one;
}

size_t renderer_occluded_count(const struct renderer *renderer)
{
    const struct occlusion *occlusion = &renderer->by_gl->surface_pass.occlusion;
    const struct draw_batches *batches = &renderer->by_gl->surface_pass.opaque;
    size_t count = 0, first_round = occlusion_round(occlusion, 0);
    for (size_t i = first_round; i < occlusion->asset_count; i++) {
        const struct occlusion_asset *asset = &occlusion->assets[i];
        const struct occlusion_box *box = &occlusion->boxes[asset->boxes_before];
        struct draw_command command;
        if (!asset->tested || box->place_count == 0)
            continue;
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        glGetNamedBufferSubData(batches->command_buffer, (GLintptr)(batches->place_of[box->first_place] * sizeof(command)), sizeof(command),
                                &command);
        count += command.instances == 0;
    }
    return count;
}
