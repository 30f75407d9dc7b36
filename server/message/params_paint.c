/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses and applies the parameters for colour bands, isolines and logarithmic colour scales. */
#include <math.h>
#include <string.h>

#include "message/json_fields.h"

static const double NUMBER_MAX = 1e12;

/* --- reading --------------------------------------------------------------------------------------------------------------- */

static bool parse_scale(const json_t *o, struct params_change *out, struct message_error *error)
{
    int scale = 0;
    bool given;
    if (!may_name(o, "scale", names_scale, &scale, &given, error))
        return false;
    out->color_scale.log = scale;
    out->given |= given ? GIVEN_SCALE : 0;
    return true;
}

/* Reads a JSON array of at most `most` ascending numbers. Returns false if the value is anything else. */
static bool take_list(const json_t *list, double *numbers, int most, int *count)
{
    *count = 0;
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *item = json_array_get(list, i);
        double number = json_number_value(item);
        if (*count == most || !json_is_number(item) || !(fabs(number) <= NUMBER_MAX) || (*count > 0 && !(number > numbers[*count - 1])))
            return false;
        numbers[(*count)++] = number;
    }
    return json_is_array(list);
}

/* Sets *error to the reason why take_list() refused the list. */
static void fail_list(const json_t *list, const char *name, int most, struct message_error *error)
{
    for (size_t i = 0; i < json_array_size(list); i++)
        if (fabs(json_number_value(json_array_get(list, i))) > NUMBER_MAX) {
            message_refuse_with(error, "bad_field", name, REFUSAL_BETWEEN, "low=%g\nhigh=%g", -NUMBER_MAX, NUMBER_MAX);
            return;
        }
    message_refuse_with(error, "bad_field", name, REFUSAL_NUMBERS, "count=%d", most);
}

static bool parse_breaks(const json_t *o, struct params_change *out, struct message_error *error)
{
    const json_t *value = json_object_get(o, "breaks");
    const char *name = json_string_value(value);
    if (!value)
        return true;
    out->given |= GIVEN_BREAKS;
    out->breaks_of_group = name && !strcmp(name, "group");
    out->breaks_of_limits = name && !strcmp(name, "limits");
    if (json_is_null(value) || out->breaks_of_group || out->breaks_of_limits ||
        take_list(value, out->color_scale.breaks, SCALE_BREAKS, &out->color_scale.break_count))
        return true;
    fail_list(value, "breaks", SCALE_BREAKS, error);
    return false;
}

static bool parse_isolines(const json_t *o, struct params_change *out, struct message_error *error)
{
    const json_t *value = json_object_get(o, "isolines");
    if (!value)
        return true;
    out->given |= GIVEN_ISOLINES;
    out->isoline_step = json_is_number(value) ? json_number_value(value) : 0;
    if (json_is_null(value) || (out->isoline_step > 0 && out->isoline_step <= NUMBER_MAX) ||
        take_list(value, out->color_scale.lines, VIEW_LINES, &out->color_scale.line_count))
        return true;
    if (out->isoline_step > NUMBER_MAX)
        message_refuse_with(error, "bad_field", "isolines", REFUSAL_BETWEEN, "low=0\nhigh=%g", NUMBER_MAX);
    else
        fail_list(value, "isolines", VIEW_LINES, error);
    return false;
}

bool params_parse_paint(const json_t *o, struct params_change *out, struct message_error *error)
{
    return parse_scale(o, out, error) && parse_breaks(o, out, error) && parse_isolines(o, out, error);
}

/* --- applying -------------------------------------------------------------------------------------------------------------- */

static bool take_breaks(const struct plant_group *group, const struct params_change *change, struct view *view, struct message_error *error)
{
    struct color_scale *color_scale = &view->color_scale;
    color_scale->break_count = 0;
    memset(color_scale->breaks, 0, sizeof(color_scale->breaks));
    if (change->breaks_of_limits) {
        for (int i = 0; i < LIMIT_COUNT; i++)
            if (isfinite(group->limits[i]))
                color_scale->breaks[color_scale->break_count++] = group->limits[i];
    } else {
        color_scale->break_count = change->breaks_of_group ? group->break_count : change->color_scale.break_count;
        memcpy(color_scale->breaks, change->breaks_of_group ? group->breaks : change->color_scale.breaks,
               (size_t)color_scale->break_count * sizeof(*color_scale->breaks));
    }
    if (color_scale->break_count > 0)
        view->ramp_interval = 0;
    if (color_scale->break_count > 0 || !(change->breaks_of_group || change->breaks_of_limits))
        return true;
    message_refuse_with(error, "bad_field", "breaks", REFUSAL_BREAKLESS, "key=%s\ngroup=%s", change->breaks_of_group ? "breaks" : "limits",
                        group->id);
    return false;
}

static bool take_isolines(const struct params_change *change, struct view *view, struct message_error *error)
{
    struct color_scale *color_scale = &view->color_scale;
    double step = change->isoline_step;
    color_scale->line_count = change->color_scale.line_count;
    memcpy(color_scale->lines, change->color_scale.lines, sizeof(color_scale->lines));
    if (step > 0 && (view->range_max - view->range_min) / step > VIEW_LINES - 1) {
        message_refuse_with(error, "bad_field", "isolines", REFUSAL_LINES, "step=%g\ncount=%d", step, VIEW_LINES);
        return false;
    }
    double first = step > 0 ? ceil(view->range_min / step - 1e-9) : 0;
    for (int i = 0; step > 0 && i < VIEW_LINES && (first + i) * step <= view->range_max + 1e-9 * step; i++)
        color_scale->lines[color_scale->line_count++] = (first + i) * step;
    return true;
}

bool params_apply_paint(const struct plant *plant, const struct params_change *change, struct view *view, struct message_error *error)
{
    const struct plant_group *group = &plant->groups[view->field.group];
    if ((change->given & GIVEN_RAMP) && change->ramp_interval > 0)
        view->color_scale.break_count = 0;
    if ((change->given & GIVEN_BREAKS) && !take_breaks(group, change, view, error))
        return false;
    if ((change->given & GIVEN_ISOLINES) && !take_isolines(change, view, error))
        return false;
    if (change->given & GIVEN_SCALE)
        view->color_scale.log = change->color_scale.log;
    if (!view->color_scale.log || view->range_min >= PLANT_LEAST_LOG)
        return true;
    message_refuse(error, "bad_field", "scale", REFUSAL_LOG);
    return false;
}
