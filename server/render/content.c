/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hashes a view field by field, since structs have padding. */
#include "render/content.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

static void add(XXH3_state_t *state, const void *bytes, size_t count)
{
    XXH3_64bits_update(state, bytes, count);
}

static void add_field_params(XXH3_state_t *state, const struct field_params *params)
{
    int32_t choices[] = { params->group,    (int32_t)params->show, params->sensor,           params->interpolation,
                          params->distance, params->fill,          (int32_t)params->baseline, (int32_t)params->trial };
    double numbers[] = { params->strength, params->decay, params->power, params->radius_m, params->reach_m };
    add(state, choices, sizeof(choices));
    add(state, numbers, sizeof(numbers));
    add(state, params->overrides, params->override_count * sizeof(*params->overrides));
}

static void add_paint(XXH3_state_t *state, const struct paint *paint)
{
    int32_t choices[] = { paint->log, paint->break_count, paint->line_count };
    add(state, choices, sizeof(choices));
    add(state, paint->breaks, (size_t)paint->break_count * sizeof(*paint->breaks));
    add(state, paint->lines, (size_t)paint->line_count * sizeof(*paint->lines));
}

/* What is hidden throws no shadow either, wherever it stands: all assets count. */
static void add_visibility(XXH3_state_t *state, const struct picture *picture)
{
    const struct visibility *visibility = &picture->view->visibility;
    size_t planes = (size_t)visibility->clip.plane_count;
    if (visibility->hidden.count + visibility->isolated.count + visibility->ghosts.count > 0)
        for (size_t i = 0; i < picture->stage->scene->asset_count; i++) {
            uint8_t look = (uint8_t)visibility_of(visibility, (int)i);
            add(state, &look, sizeof(look));
        }
    add(state, visibility->clip.planes, planes * sizeof(visibility->clip.planes[0]));
}

/* All but the field and its colours. */
static void add_shape(XXH3_state_t *state, const struct picture *picture)
{
    const struct view *view = picture->view;
    int32_t choices[] = { view->width_px,       view->height_px,   (int32_t)view->look,           (int32_t)view->tier,
                          view->selected_asset, view->environment, (int32_t)view->field.trial, view->dark };
    double numbers[] = { view->camera.fov_deg, view->camera.height_m };
    add(state, choices, sizeof(choices));
    add(state, numbers, sizeof(numbers));
    add(state, view->camera.eye_m, sizeof(view->camera.eye_m));
    add(state, view->camera.target_m, sizeof(view->camera.target_m));
    add(state, view->camera.up, sizeof(view->camera.up));
    add(state, view->light_dir, sizeof(view->light_dir));
    add(state, picture->lit_by.towards, sizeof(picture->lit_by.towards));
    add(state, &picture->lit_by.environment, sizeof(picture->lit_by.environment));
    add(state, &picture->lit_by.rough, sizeof(picture->lit_by.rough));
    bool own_shadows = visibility_equal(&picture->lit_by.shown, &view->visibility);
    add(state, &own_shadows, sizeof(own_shadows));
    add_visibility(state, picture);
}

static void add_colors(XXH3_state_t *state, const struct view *view)
{
    double numbers[] = { view->colormap, view->ramp_interval, view->range_min, view->range_max };
    add(state, numbers, sizeof(numbers));
    add(state, &view->at_us, sizeof(view->at_us)); /* the same picture of another instant says another time */
    add_field_params(state, &view->field);
    add_paint(state, &view->paint);
}

uint64_t content_hash(const struct picture *picture)
{
    XXH3_state_t state;
    XXH3_INITSTATE(&state);
    XXH3_64bits_reset(&state);
    add_shape(&state, picture);
    add_colors(&state, picture->view);
    for (size_t i = 0; i < picture->visible_count; i++) {
        int asset = picture->visible[i];
        uint64_t one[2] = { (uint64_t)asset, picture->fields[asset] ? picture->fields[asset]->content : 0 };
        add(&state, one, sizeof(one));
    }
    return XXH3_64bits_digest(&state);
}

uint64_t content_shape_hash(const struct picture *picture)
{
    XXH3_state_t state;
    XXH3_INITSTATE(&state);
    XXH3_64bits_reset(&state);
    add_shape(&state, picture);
    for (size_t i = 0; i < picture->visible_count; i++) {
        int one[2] = { picture->visible[i], picture->fields[picture->visible[i]] != NULL };
        add(&state, one, sizeof(one));
    }
    return XXH3_64bits_digest(&state);
}
