/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Functions on a frame context (frame_context.h) that all render backends use. */
#include "render/frame_context.h"

#include "render/plan/lod_selection.h"

static const double SUN_SLACK_TEXELS = 3;

const struct model_level *frame_level(const struct frame_context *context, int asset)
{
    return lod_level(context->gpu_scene, &context->constants, asset, context->error_px);
}

bool frame_shows_selected(const struct frame_context *context)
{
    const struct visibility *visibility = &context->view->visibility;
    int selected = context->view->selected_asset;
    if (selected < 0 || visibility_of(visibility, selected) == ASSET_HIDDEN)
        return false;
    const struct scene_asset *asset = &context->gpu_scene->scene->assets[selected];
    return view_constants_sees(&context->constants, asset) && !clip_drops(&visibility->clip, asset->bounds_min_m, asset->bounds_max_m);
}

int frame_triangles(const struct frame_context *context)
{
    int count = 0;
    for (size_t i = 0; i < context->visible_count; i++)
        count += frame_level(context, context->visible[i])->triangles;
    return count;
}

double frame_sun_slack(const struct frame_context *context)
{
    return SUN_SLACK_TEXELS * context->light->texel_m / context->light->depth_m;
}

int64_t frame_oldest_age_ns(const struct frame_context *context)
{
    int64_t oldest_ns = INT64_MAX;
    for (size_t i = 0; i < context->visible_count; i++) {
        const struct fields_entry *field = context->fields[context->visible[i]];
        if (field && field->oldest_age_ns != INT64_MAX && (oldest_ns == INT64_MAX || field->oldest_age_ns > oldest_ns))
            oldest_ns = field->oldest_age_ns;
    }
    return oldest_ns;
}
