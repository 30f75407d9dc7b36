/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hashes what a frame shows (content_hash.h). Views are hashed member by member, because structs have padding bytes. */
#include "render/plan/content_hash.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

static void hash_bytes(XXH3_state_t *state, const void *bytes, size_t count)
{
    XXH3_64bits_update(state, bytes, count);
}

static void add_field_params(XXH3_state_t *state, const struct field_params *params)
{
    int32_t choices[] = { params->group, (int32_t)params->show,     params->sensor,        params->interpolation, params->distance,
                          params->fill,  (int32_t)params->baseline, (int32_t)params->trial };
    double numbers[] = { params->strength, params->decay, params->power, params->radius_m, params->reach_m };
    hash_bytes(state, choices, sizeof(choices));
    hash_bytes(state, numbers, sizeof(numbers));
    hash_bytes(state, params->overrides, params->override_count * sizeof(*params->overrides));
}

static void add_color_scale(XXH3_state_t *state, const struct color_scale *color_scale)
{
    int32_t choices[] = { color_scale->log, color_scale->break_count, color_scale->line_count };
    hash_bytes(state, choices, sizeof(choices));
    hash_bytes(state, color_scale->breaks, (size_t)color_scale->break_count * sizeof(*color_scale->breaks));
    hash_bytes(state, color_scale->lines, (size_t)color_scale->line_count * sizeof(*color_scale->lines));
}

/* Hashes the visibility of all assets, including those outside the view, because hidden assets cast no shadow. */
static void add_visibility(XXH3_state_t *state, const struct frame_plan *plan)
{
    const struct visibility *visibility = &plan->view.visibility;
    size_t planes = (size_t)visibility->clip.plane_count;
    if (visibility->hidden.count + visibility->isolated.count + visibility->ghosts.count > 0)
        for (size_t i = 0; i < plan->gpu_scene->scene->asset_count; i++) {
            uint8_t look = (uint8_t)visibility_of(visibility, (int)i);
            hash_bytes(state, &look, sizeof(look));
        }
    hash_bytes(state, visibility->clip.planes, planes * sizeof(visibility->clip.planes[0]));
}

/* Hashes everything that a frame shows except the field's values and colours: camera, visible assets, light, and the group, whose
   sensors' markers are part of the frame. In the operator view, surfaces without a field are grey. */
static void add_shape(XXH3_state_t *state, const struct frame_plan *plan)
{
    const struct view *view = &plan->view;
    int32_t choices[] = { view->width_px,           view->height_px,   (int32_t)view->look,        (int32_t)view->tier,
                          view->selected_asset,     view->environment, (int32_t)view->field.trial, view->dark,
                          (int32_t)view->directions, view->field.group, view_is_operator(view) };
    double numbers[] = { view->camera.fov_deg, view->camera.height_m };
    hash_bytes(state, choices, sizeof(choices));
    hash_bytes(state, numbers, sizeof(numbers));
    hash_bytes(state, view->camera.eye_m, sizeof(view->camera.eye_m));
    hash_bytes(state, view->camera.target_m, sizeof(view->camera.target_m));
    hash_bytes(state, view->camera.up, sizeof(view->camera.up));
    hash_bytes(state, view->light_dir, sizeof(view->light_dir));
    hash_bytes(state, plan->lit_by.towards, sizeof(plan->lit_by.towards));
    hash_bytes(state, &plan->lit_by.environment, sizeof(plan->lit_by.environment));
    hash_bytes(state, &plan->lit_by.rough, sizeof(plan->lit_by.rough));
    bool own_shadows = visibility_equal(&plan->lit_by.shown, &view->visibility);
    hash_bytes(state, &own_shadows, sizeof(own_shadows));
    add_visibility(state, plan);
}

static void add_colors(XXH3_state_t *state, const struct view *view)
{
    double numbers[] = { view->colormap, view->ramp_interval, view->range_min, view->range_max };
    hash_bytes(state, numbers, sizeof(numbers));
    /* includes the instant, because it is part of the frame: frames of two instants differ even if their pixels are equal */
    hash_bytes(state, &view->at_us, sizeof(view->at_us));
    add_field_params(state, &view->field);
    add_color_scale(state, &view->color_scale);
}

uint64_t content_hash(const struct frame_plan *plan)
{
    XXH3_state_t state;
    XXH3_INITSTATE(&state);
    XXH3_64bits_reset(&state);
    add_shape(&state, plan);
    add_colors(&state, &plan->view);
    for (size_t i = 0; i < plan->visible_count; i++) {
        int asset = plan->visible[i];
        const struct fields_entry *entry = plan->fields[asset];
        uint64_t one[3] = { (uint64_t)asset, entry ? entry->content : 0, entry ? entry->directions_content : 0 };
        hash_bytes(&state, one, sizeof(one));
    }
    return XXH3_64bits_digest(&state);
}

uint64_t content_hash_shape(const struct frame_plan *plan)
{
    XXH3_state_t state;
    XXH3_INITSTATE(&state);
    XXH3_64bits_reset(&state);
    add_shape(&state, plan);
    for (size_t i = 0; i < plan->visible_count; i++) {
        int one[2] = { plan->visible[i], plan->fields[plan->visible[i]] != NULL };
        hash_bytes(&state, one, sizeof(one));
    }
    return XXH3_64bits_digest(&state);
}
