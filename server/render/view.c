/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Default views, halves of split views (two pictures side by side), and equality of views. */
#include "render/view.h"
#include "base/math/search.h"
#include "plant/colormaps.h"
#include "scene/scene_create.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Default sun: late morning, over the viewer's shoulder, so that shapes read well and shadows stay short. The direction does not depend on
   the frame's aspect ratio, so that all sessions of a plant share one baked light set. */
void view_default_light(const struct scene *scene, double towards[3])
{
    int up = scene->plant->up == AXIS_Y ? 1 : 2, a = 0, b = up == 1 ? 2 : 1;
    struct camera home;
    double away[3];
    scene_home(scene, 16.0 / 9, &home);
    for (int i = 0; i < 3; i++)
        away[i] = home.eye_m[i] - home.target_m[i];
    double flat = hypot(away[a], away[b]), turn = (up == 1 ? 1 : -1) * 0.85, height = 0.87;
    double x = flat > 0 ? away[a] / flat : 1, y = flat > 0 ? away[b] / flat : 0, across = sqrt(1 - height * height);
    towards[a] = across * (x * cos(turn) - y * sin(turn));
    towards[b] = across * (x * sin(turn) + y * cos(turn));
    towards[up] = height;
}

const char *view_unit(const struct plant *plant, const struct view *view)
{
    const char *unit = plant->groups[view->field.group].unit;
    return view->field.show == SHOW_DISTANCE ? "m" : view_is_operator(view) || !unit ? "" : unit;
}

bool view_shows_readings(const struct view *view)
{
    bool left = view->field.show != SHOW_DISTANCE && view->look != LOOK_MATERIALS;
    return left || (view->split && view->right.field.show != SHOW_DISTANCE && view->right.look != LOOK_MATERIALS);
}

void view_default_scale(const struct scene *scene, struct view *view)
{
    const struct plant_group *group = &scene->plant->groups[view->field.group];
    field_default_range(scene, &view->field, &view->range_min, &view->range_max);
    view->ramp_interval = 0;
    memset(&view->color_scale, 0, sizeof(view->color_scale));
    /* the scale is logarithmic in the view of blind spots: its value (how much hotter than its surroundings a spot must be to be
       detected) grows as exp(D^2) with the distance D from the nearest sensor */
    view->color_scale.log = view->field.show == SHOW_BLIND;
    if (view->field.show != SHOW_VALUE)
        return;
    view->color_scale.log = group->log;
    view->color_scale.line_count = group->isoline_count;
    memcpy(view->color_scale.lines, group->isolines, sizeof(group->isolines));
}

int view_default_colormap(const struct plant *plant, enum field_show show)
{
    return show == SHOW_DIFFERENCE ? colormap_find(plant, "diverging") : 0;
}

void view_default(const struct scene *scene, int width_px, int height_px, struct view *view)
{
    const struct plant *plant = scene->plant;
    memset(view, 0, sizeof(*view));
    view->width_px = width_px;
    view->height_px = height_px;
    scene_home(scene, (double)width_px / height_px, &view->camera);
    view->selected_asset = -1;
    view->tier = TIER_REFINED;
    if (plant->group_count > 0) {
        field_params_default(plant, 0, &view->field);
        field_params_set_show(plant, &view->field, plant->display.show == PLANT_SHOW_OPERATOR ? SHOW_OPERATOR : SHOW_VALUE);
        view_default_scale(scene, view);
    }
    view_default_light(scene, view->light_dir);
    visibility_start(plant, &view->visibility);
    view->environment = plant->display.environment_count > 0 ? 1 : 0;
}

bool view_is_operator(const struct view *view)
{
    return view->field.show == SHOW_OPERATOR;
}

/* Sets all members of `scale` except the colour map, from the settings of the view. */
static void set_scale(const struct view *view, struct scale *scale)
{
    if (view_is_operator(view)) {
        *scale = (struct scale){ .min = -LIMIT_PLACE_MOST, .max = LIMIT_PLACE_MOST };
        return;
    }
    *scale = (struct scale){
        .min = view->range_min,
        .max = view->range_max,
        .log = view->color_scale.log,
        .interval = view->ramp_interval,
        .break_count = view->color_scale.break_count,
    };
    memcpy(scale->breaks, view->color_scale.breaks, sizeof(scale->breaks));
}

void view_scale(const struct plant *plant, const struct view *view, struct scale *scale)
{
    set_scale(view, scale);
    scale->map = view_is_operator(view) ? &colormap_operator : colormap_at(plant, (size_t)view->colormap);
}

static void get_half(const struct view *view, struct split_half *out)
{
    *out = (struct split_half){
        .field = view->field,
        .colormap = view->colormap,
        .ramp_interval = view->ramp_interval,
        .range_min = view->range_min,
        .range_max = view->range_max,
        .color_scale = view->color_scale,
        .look = view->look,
    };
}

static void set_half(struct view *view, const struct split_half *shown)
{
    view->field = shown->field;
    view->colormap = shown->colormap;
    view->ramp_interval = shown->ramp_interval;
    view->range_min = shown->range_min;
    view->range_max = shown->range_max;
    view->color_scale = shown->color_scale;
    view->look = shown->look;
}

int view_left_px(const struct view *view)
{
    return view->width_px / 2;
}

void view_half(const struct view *view, int half, struct view *out)
{
    *out = *view;
    out->split = false;
    memset(&out->right, 0, sizeof(out->right));
    if (!view->split)
        return;
    out->width_px = half ? view->width_px - view_left_px(view) : view_left_px(view);
    if (half)
        set_half(out, &view->right);
}

void view_split(struct view *view, const struct view *right)
{
    view->split = true;
    get_half(right, &view->right);
}

int view_lines(const struct view *view, double lines[VIEW_ALL_LINES])
{
    static const double limits[LIMIT_COUNT] = { -2, -1, 1, 2 };
    if (view_is_operator(view)) {
        memcpy(lines, limits, sizeof(limits));
        return LIMIT_COUNT;
    }
    struct scale scale;
    set_scale(view, &scale);
    int count = scale_edges(&scale, lines), distinct = 0;
    memcpy(lines + count, view->color_scale.lines, (size_t)view->color_scale.line_count * sizeof(*lines));
    count += view->color_scale.line_count;
    qsort(lines, (size_t)count, sizeof(*lines), compare_doubles);
    for (int i = 0; i < count; i++)
        if ((distinct == 0 || lines[i] != lines[distinct - 1]) && lines[i] >= scale.min && lines[i] <= scale.max)
            lines[distinct++] = lines[i];
    return distinct;
}

static bool same_vector(const double a[3], const double b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static bool same_camera(const struct camera *a, const struct camera *b)
{
    return same_vector(a->eye_m, b->eye_m) && same_vector(a->target_m, b->target_m) && same_vector(a->up, b->up) &&
           a->fov_deg == b->fov_deg && a->height_m == b->height_m;
}

static bool same_numbers(const double *a, int a_count, const double *b, int b_count)
{
    return a_count == b_count && memcmp(a, b, (size_t)a_count * sizeof(*a)) == 0;
}

static bool same_color_scale(const struct color_scale *a, const struct color_scale *b)
{
    return a->log == b->log && same_numbers(a->breaks, a->break_count, b->breaks, b->break_count) &&
           same_numbers(a->lines, a->line_count, b->lines, b->line_count);
}

static bool same_half(const struct split_half *a, const struct split_half *b)
{
    return field_params_equal(&a->field, &b->field) && a->colormap == b->colormap && a->ramp_interval == b->ramp_interval &&
           a->range_min == b->range_min && a->range_max == b->range_max && same_color_scale(&a->color_scale, &b->color_scale) &&
           a->look == b->look;
}

void view_set_trial(struct view *view, uint32_t trial)
{
    view->field.trial = trial;
    if (view->split)
        view->right.field.trial = trial;
}

void view_set_instant(struct view *view, int64_t at_us, int slot)
{
    view->at_us = at_us;
    view->field.slot = slot;
    if (view->split)
        view->right.field.slot = slot;
}

bool view_equal(const struct view *a, const struct view *b)
{
    struct split_half a_shown, b_shown;
    get_half(a, &a_shown);
    get_half(b, &b_shown);
    return a->width_px == b->width_px && a->height_px == b->height_px && same_camera(&a->camera, &b->camera) && a->tier == b->tier &&
           a->selected_asset == b->selected_asset && same_vector(a->light_dir, b->light_dir) && a->environment == b->environment &&
           a->dark == b->dark && a->strip == b->strip && a->language == b->language && a->directions == b->directions &&
           same_half(&a_shown, &b_shown) && visibility_equal(&a->visibility, &b->visibility) && a->at_us == b->at_us &&
           a->split == b->split && (!a->split || same_half(&a->right, &b->right));
}
