/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prepares the fields, the light and the colour map of a frame for the backends. */
#include "render/plan/content_hash.h"
#include "render/render_job.h"
#include "render/renderer_impl.h"

void renderer_upload_fields(struct renderer *renderer, const struct frame_plan *plan, const struct frame_context *context,
                            struct frame *frame)
{
    struct frame_plan shown = *plan;
    if (fields_upload(&renderer->fields, context->visible, context->visible_count, context->fields))
        return;
    shown.fields = context->fields;
    frame->content = content_hash(&shown);
    frame->oldest_age_ns = frame_oldest_age_ns(context);
}

bool renderer_find_light(struct renderer *renderer, struct frame_context *context)
{
    if (!context->light)
        context->light = light_get(&renderer->light, &context->lit_by);
    context->colormap = shaded_colormap_cache_get(&renderer->colormaps, renderer->scene->plant, context->view);
    return context->light && context->colormap.colors;
}

bool renderer_light_job(struct renderer *renderer, struct render_job *job)
{
    if (!job->light) {
        job->light = light_get(&renderer->light, &job->context.lit_by);
        if (!job->light)
            return false;
        light_hold(job->light);
        job->context.light = job->light;
    }
    return renderer_find_light(renderer, &job->context);
}
