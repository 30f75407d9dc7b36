/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes a view as arguments of an HTTP query. Includes values that equal the plant's defaults, because the defaults may change later. */
#include "message/view_query_write.h"

#include <math.h>

#include "base/text/text.h"
#include "message/names.h"
#include "plant/colormaps.h"

/* tolerance for comparing a view's unit vectors, because parsing the written query normalises them again */
static const double ROUNDING = 1e-12;

/* --- lists of arguments ------------------------------------------------------------------------------------------------------- */

static void add_number(struct text *text, const char *before, double value)
{
    text_add(text, "%s%.17g", before, value);
}

static void add_numbers(struct text *text, const double *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        add_number(text, i > 0 ? "," : "", values[i]);
}

/* Adds the argument NAME=TEXT, with TEXT from `text`, and empties `text` for the next argument. Returns false if `out` has no
   room for more. */
static bool flush(struct view_address *out, const char *name, struct text *text)
{
    bool good = view_address_add(out, name, text->length > 0 ? text->at : "");
    text->length = 0;
    return good;
}

static bool put_number(struct view_address *out, const char *name, double value)
{
    struct text text = { 0 };
    add_number(&text, "", value);
    bool good = flush(out, name, &text);
    text_finish(&text);
    return good;
}

static bool put_numbers(struct view_address *out, const char *name, const double *values, size_t count)
{
    struct text text = { 0 };
    add_numbers(&text, values, count);
    bool good = flush(out, name, &text);
    text_finish(&text);
    return good;
}

/* Adds an argument whose value is a list of numbers, or `none` if the list is empty. */
static bool put_list(struct view_address *out, const char *name, const double *values, int count)
{
    return count > 0 ? put_numbers(out, name, values, (size_t)count) : view_address_add(out, name, "none");
}

/* --- parameters of one half of a split view (two pictures side by side) --------------------------------------------------- */

static bool put_overrides(struct view_address *out, const struct plant *plant, const struct field_params *field)
{
    struct text text = { 0 };
    for (size_t i = 0; i < field->override_count; i++) {
        const struct field_override *override = &field->overrides[i];
        text_add(&text, "%s%s=", i > 0 ? "," : "", plant->tags[override->tag].name);
        if (override->strength >= 0)
            add_number(&text, "", (double) override->strength);
        if (override->decay >= 0)
            add_number(&text, ":", (double) override->decay);
    }
    bool good = field->override_count == 0 || flush(out, "sensors", &text);
    text_finish(&text);
    return good;
}

static bool put_baseline(struct view_address *out, struct baselines *baselines, uint32_t id, struct message_error *error)
{
    struct baseline found;
    if (id == 0)
        return true;
    if (baselines && baselines_describe(baselines, id, &found) && found.name[0])
        return view_address_add(out, "baseline", found.name);
    message_refuse(error, "not_signed", "difference", REFUSAL_UNSIGNED_BASELINE);
    return false;
}

static bool put_field(struct view_address *out, const struct params_context *context, const struct field_params *field,
                      struct message_error *error)
{
    const struct plant *plant = context->scene->plant;
    return view_address_add(out, "group", plant->groups[field->group].id) &&
           view_address_add(out, "show", name_of(names_show, (int)field->show)) &&
           (field->sensor < 0 || view_address_add(out, "sensor", plant->tags[field->sensor].name)) &&
           put_baseline(out, context->baselines, field->baseline, error) && put_overrides(out, plant, field) &&
           view_address_add(out, "interpolation", name_of(names_interpolation, (int)field->interpolation)) &&
           view_address_add(out, "distance", name_of(names_distance, (int)field->distance)) &&
           view_address_add(out, "fill", name_of(names_fill, (int)field->fill)) && put_number(out, "strength", field->strength) &&
           put_number(out, "decay", field->decay) && put_number(out, "power", field->power) &&
           put_number(out, "radius_m", field->radius_m) &&
           (isfinite(field->reach_m) ? put_number(out, "reach_m", field->reach_m) : view_address_add(out, "reach_m", "none"));
}

static bool put_half(struct view_address *out, const struct params_context *context, const struct view *half, struct message_error *error)
{
    const struct color_scale *scale = &half->color_scale;
    const struct colormap *map = colormap_at(context->scene->plant, (size_t)half->colormap);
    return put_field(out, context, &half->field, error) && view_address_add(out, "colormap", map->name) &&
           put_number(out, "ramp_interval", half->ramp_interval) &&
           put_numbers(out, "range", (double[2]){ half->range_min, half->range_max }, 2) &&
           view_address_add(out, "scale", name_of(names_scale, scale->log)) && put_list(out, "breaks", scale->breaks, scale->break_count) &&
           put_list(out, "isolines", scale->lines, scale->line_count) &&
           view_address_add(out, "look", name_of(names_look, (int)half->look));
}

/* Adds the parameters of the right half of a split view (two pictures side by side) as one argument, NAME=VALUE;... */
static bool put_split(struct view_address *out, const struct params_context *context, const struct view *view, struct message_error *error)
{
    struct view_address right = { .count = 0 };
    struct text text = { 0 };
    struct view half;
    if (!view->split)
        return true;
    view_half(view, 1, &half);
    bool good = put_half(&right, context, &half, error);
    for (size_t i = 0; i < right.count; i++)
        text_add(&text, "%s%s", i > 0 ? ";" : "", right.args[i]);
    good = good && flush(out, "split", &text);
    text_finish(&text);
    view_address_finish(&right);
    return good;
}

/* --- parameters that both halves of a split view (two pictures side by side) share ---------------------------------------- */

static bool put_camera(struct view_address *out, const struct camera *camera)
{
    const double numbers[7] = { camera->eye_m[0],    camera->eye_m[1],    camera->eye_m[2], camera->target_m[0],
                                camera->target_m[1], camera->target_m[2], camera->fov_deg };
    return put_numbers(out, "camera", numbers, 7) && put_numbers(out, "up", camera->up, 3) &&
           (camera->height_m <= 0 || (view_address_add(out, "projection", name_of(names_projection, PROJECTION_ORTHOGRAPHIC)) &&
                                      put_number(out, "height_m", camera->height_m)));
}

static bool put_set(struct view_address *out, const struct plant *plant, const char *name, const struct asset_set *set)
{
    struct text text = { 0 };
    for (size_t i = 0; i < plant->asset_count && set->count > 0; i++)
        if (asset_set_has(set, (int)i))
            text_add(&text, "%s%s", text.length > 0 ? "," : "", plant->assets[i].id);
    bool good = flush(out, name, &text);
    text_finish(&text);
    return good;
}

static bool put_clip(struct view_address *out, const struct clip *clip)
{
    struct text text = { 0 };
    double box[6];
    if (clip->plane_count == 0)
        return true;
    if (clip->is_box) {
        clip_get_box(clip, box, box + 3);
        return put_numbers(out, "clip_box", box, 6);
    }
    for (int i = 0; i < clip->plane_count; i++) {
        text_add(&text, "%s", i > 0 ? ";" : "");
        add_numbers(&text, clip->planes[i], 4);
    }
    bool good = flush(out, "clip", &text);
    text_finish(&text);
    return good;
}

static bool put_common(struct view_address *out, const struct plant *plant, const struct view *view)
{
    return put_numbers(out, "light", view->light_dir, 3) &&
           view_address_add(out, "environment", view->environment ? plant->display.environments[view->environment - 1].name : "sky") &&
           view_address_add(out, "backdrop", name_of(names_backdrop, view->dark)) &&
           view_address_add(out, "arrows", name_of(names_arrows, (int)view->directions)) &&
           view_address_add(out, "strip", name_of(names_strip, view->strip)) &&
           (view->language == LANGUAGE_EN || view_address_add(out, "language", name_of(names_language, (int)view->language))) &&
           (view->selected_asset < 0 || view_address_add(out, "selected", plant->assets[view->selected_asset].id)) &&
           put_set(out, plant, "hidden", &view->visibility.hidden) && put_set(out, plant, "isolate", &view->visibility.isolated) &&
           put_set(out, plant, "ghost", &view->visibility.ghosts) && put_clip(out, &view->visibility.clip);
}

/* --- the whole query ------------------------------------------------------------------------------------------------------------ */

static void round_alike(double *to, const double *from, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (fabs(to[i] - from[i]) <= ROUNDING * fmax(fabs(from[i]), 1))
            to[i] = from[i];
}

static bool is_said(const struct params_context *context, const struct view *view, const struct view_address *said,
                    struct message_error *error)
{
    struct message_error inner = { 0 };
    struct view read;
    bool good = view_query_parse(context, ROLE_ENGINEER, (const char *const *)said->args, said->count, &read, NULL, &inner);
    if (good) {
        read.tier = view->tier;
        view_set_instant(&read, view->at_us, view->field.slot);
        round_alike(read.light_dir, view->light_dir, 3);
        for (int i = 0; i < read.visibility.clip.plane_count && i < view->visibility.clip.plane_count; i++)
            round_alike(read.visibility.clip.planes[i], view->visibility.clip.planes[i], 4);
        good = view_equal(&read, view);
    }
    if (!good)
        message_fail(error, "not_signed", "the view cannot be written as a URL query%s%.100s", inner.code ? ": " : "",
                     inner.code ? inner.text : "");
    return good;
}

bool view_query_write(const struct params_context *context, const struct view *view, struct view_address *out, struct message_error *error)
{
    struct view left;
    *out = (struct view_address){ .count = 0 };
    if (view->field.trial) {
        message_refuse(error, "not_signed", NULL, REFUSAL_UNSIGNED_TRIAL);
        return false;
    }
    view_half(view, 0, &left);
    bool good = put_number(out, "width", view->width_px) && put_number(out, "height", view->height_px) && put_camera(out, &view->camera) &&
                put_half(out, context, &left, error) && put_split(out, context, view, error) &&
                put_common(out, context->scene->plant, view);
    if (!good && !error->code)
        message_refuse(error, "not_signed", NULL, REFUSAL_UNSIGNED_LONG);
    return good && is_said(context, view, out, error);
}
