/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses and applies the parameters that select the quantity shown (values, distance from a sensor, difference from a
   baseline), and overrides for single sensors. */
#include <string.h>

#include "message/json_fields.h"
#include "plant/colormaps.h"
#include "plant/singles.h"

static const char *const NOW = "now";

/* --- reading --------------------------------------------------------------------------------------------------------------- */

/* Returns the index of the tag with that name; -1 with *error if there is none. */
static int find_tag(const struct plant *plant, const char *field, const char *tag, struct message_error *error)
{
    char name[48];
    int found = plant_find_tag(plant, tag);
    if (found < 0)
        message_refuse_with(error, "bad_field", field, REFUSAL_NO_TAG, "name=%s", quoted(tag, name));
    return found;
}

static bool parse_sensor(const struct plant *plant, const json_t *o, struct params_change *out, struct message_error *error)
{
    const json_t *value = json_object_get(o, "sensor");
    out->field.sensor = -1;
    if (!value)
        return true;
    out->given |= GIVEN_SENSOR;
    if (json_is_null(value))
        return true;
    if (!json_is_string(value)) {
        message_fail(error, "bad_field", "sensor: expected a tag or null");
        return false;
    }
    out->field.sensor = find_tag(plant, "sensor", json_string_value(value), error);
    return out->field.sensor >= 0;
}

static bool may_factor(const json_t *o, const char *name, float *out, struct message_error *error)
{
    double value;
    bool given;
    if (!may_number(o, name, 0, 100, &value, &given, error))
        return false;
    *out = given ? (float)value : FIELD_AS_CONFIGURED;
    return true;
}

static bool parse_override(const struct plant *plant, const char *tag, const json_t *value, struct params_change *out,
                           struct message_error *error)
{
    struct field_override override = { .tag = find_tag(plant, "sensors", tag, error) };
    if (override.tag < 0)
        return false;
    if (out->field.override_count == FIELD_OVERRIDES) {
        message_refuse_with(error, "bad_field", "sensors", REFUSAL_OVERRIDES, "count=%d", FIELD_OVERRIDES);
        return false;
    }
    if (!json_is_object(value) && !json_is_null(value)) {
        message_fail(error, "bad_field", "sensors: expected {\"strength\", \"decay\"} or null for each tag");
        return false;
    }
    if (!may_factor(value, "strength", &override.strength, error) || !may_factor(value, "decay", &override.decay, error))
        return false;
    out->field.overrides[out->field.override_count++] = override;
    return true;
}

static bool parse_sensors(const struct plant *plant, const json_t *o, struct params_change *out, struct message_error *error)
{
    json_t *all = json_object_get(o, "sensors"), *value;
    const char *tag;
    if (!all)
        return true;
    out->given |= GIVEN_SENSORS;
    out->only_these_sensors = json_is_null(all);
    if (!json_is_object(all) && !json_is_null(all)) {
        message_fail(error, "bad_field", "sensors: expected an object with one key for each tag, or null");
        return false;
    }
    json_object_foreach(all, tag, value) if (!parse_override(plant, tag, value, out, error)) return false;
    return true;
}

static bool take_name(const json_t *value, enum baseline_change what, struct params_change *out, struct message_error *error)
{
    const char *name = json_string_value(value);
    out->baseline = what;
    if (name && name[0] && strlen(name) < sizeof(out->baseline_name) && !has_controls(name) &&
        !(what == BASELINE_SET && !strcmp(name, NOW))) {
        strcpy(out->baseline_name, name);
        return true;
    }
    message_refuse_with(error, "bad_field", "baseline", REFUSAL_NAME_EXPECTED, "bytes=%zu", sizeof(out->baseline_name) - 1);
    return false;
}

static bool parse_baseline(const json_t *o, struct params_change *out, struct message_error *error)
{
    const json_t *value = json_object_get(o, "baseline"), *set = json_object_get(value, "set"), *remove = json_object_get(value, "remove");
    if (!value)
        return true;
    if (json_is_null(value))
        out->baseline = BASELINE_NONE;
    else if (json_is_string(value) && !strcmp(json_string_value(value), NOW))
        out->baseline = BASELINE_NOW;
    else if (json_is_string(value))
        return take_name(value, BASELINE_NAMED, out, error);
    else if (set && !remove)
        return take_name(set, BASELINE_SET, out, error);
    else if (remove && !set)
        return take_name(remove, BASELINE_REMOVE, out, error);
    else
        message_fail(error, "bad_field", "baseline: expected a name, 'now', {\"set\": name}, {\"remove\": name} or null");
    return out->baseline != BASELINE_STAYS;
}

bool params_parse_show(const struct plant *plant, const json_t *o, struct params_change *out, struct message_error *error)
{
    int show = SHOW_VALUE;
    bool given;
    if (!may_name(o, "show", names_show, &show, &given, error))
        return false;
    out->field.show = (enum field_show)show;
    out->given |= given ? GIVEN_SHOW : 0;
    return parse_sensor(plant, o, out, error) && parse_sensors(plant, o, out, error) && parse_baseline(o, out, error);
}

/* --- applying -------------------------------------------------------------------------------------------------------------- */

static bool apply_sensors(const struct params_change *change, struct field_params *field, struct message_error *error)
{
    if (change->only_these_sensors) {
        memset(field->overrides, 0, sizeof(field->overrides));
        field->override_count = 0;
    }
    for (size_t i = 0; i < change->field.override_count; i++)
        if (!field_params_override(field, change->field.overrides[i])) {
            message_refuse_with(error, "bad_field", "sensors", REFUSAL_OVERRIDES, "count=%d", FIELD_OVERRIDES);
            return false;
        }
    return true;
}

/* Sets field->baseline to the id of the baseline named in the change. A baseline that the change is about to store gets a
   placeholder id, which params_apply_baseline() replaces. Returns false with *error if there is no such baseline. */
static bool find_baseline(const struct params_context *context, const struct params_change *change, struct field_params *field,
                          struct message_error *error)
{
    char name[48];
    bool keeps = change->baseline == BASELINE_NOW || change->baseline == BASELINE_SET;
    if (change->baseline == BASELINE_NONE)
        field->baseline = 0;
    if (change->baseline <= BASELINE_NONE)
        return true;
    if (!context->baselines || (change->baseline != BASELINE_NAMED && !context->snapshot)) {
        message_fail(error, "bad_field",
                     "baseline: not possible here, because this request has no saved baselines (readings to compare with) or no readings");
        return false;
    }
    if (change->baseline == BASELINE_SET && !baselines_may_set(context->baselines, change->baseline_name)) {
        message_refuse_with(error, "bad_field", "baseline", REFUSAL_KEPT, "count=%d", BASELINES_NAMED);
        return false;
    }
    uint32_t found = keeps ? UINT32_MAX : baselines_find(context->baselines, change->baseline_name);
    if (!found) {
        message_refuse_with(error, "bad_field", "baseline", REFUSAL_UNKNOWN, "name=%s", quoted(change->baseline_name, name));
        return false;
    }
    if (change->baseline != BASELINE_REMOVE)
        field->baseline = found;
    return true;
}

/* If the change makes the view show another kind of number (values, distances, differences), sets a range and colours that suit it. */
static void take_quantity(const struct params_context *context, const struct field_params *before, struct view *view)
{
    const struct field_params *now = &view->field;
    bool other = now->show != before->show;
    bool other_distance = now->show == SHOW_DISTANCE && (now->sensor != before->sensor || now->distance != before->distance);
    if (!other && !other_distance)
        return;
    view_default_scale(context->scene, view);
    if (now->show == SHOW_DIFFERENCE || before->show == SHOW_DIFFERENCE)
        view->colormap = view_default_colormap(context->scene->plant, now->show);
}

/* Returns true if the view can be drawn correctly, otherwise fills *error. An asset with only one sensor may have a surface
   whose triangles are not subdivided (plant_cuts_singles()); the interpolation `paper` and distances from a sensor cannot be
   drawn correctly on such a surface. */
static bool may_show(const struct plant *plant, const struct field_params *field, struct message_error *error)
{
    char group[48], asset[48];
    int first;
    const struct plant_group *of = &plant->groups[field->group];
    if (field->show == SHOW_DISTANCE && plant->tags[field->sensor].place.assumed) {
        message_refuse_with(error, "bad_field", "sensor", REFUSAL_ASSUMED, "asset=%s",
                            quoted(plant->assets[plant->tags[field->sensor].asset].id, asset));
        return false;
    }
    if (plant_cuts_singles(of))
        return true;
    size_t count = field->interpolation == INTERPOLATION_PAPER ? plant_singles(plant, field->group, &first) : 0;
    if (count > 0)
        message_refuse_with(error, "bad_field", "interpolation", REFUSAL_UNCUT, "group=%s\ncount=%zu\nall=%zu\nasset=%s",
                            quoted(of->id, group), count, plant->asset_count, quoted(plant->assets[first].id, asset));
    else if (field->show == SHOW_DISTANCE && plant_is_single(plant, field->sensor))
        message_refuse_with(error, "bad_field", "sensor", REFUSAL_FAR_UNCUT, "group=%s\nasset=%s", quoted(of->id, group),
                            quoted(plant->assets[plant->tags[field->sensor].asset].id, asset));
    else
        return true;
    return false;
}

bool params_apply_show(const struct params_context *context, const struct params_change *change, const struct view *before,
                       struct view *view, struct message_error *error)
{
    struct field_params *field = &view->field;
    if ((change->given & GIVEN_SHOW) && (change->given & GIVEN_INTERPOLATION))
        field->show = change->field.show;
    else if (change->given & GIVEN_SHOW)
        field_params_set_show(context->scene->plant, field, change->field.show);
    if (change->given & GIVEN_SENSOR)
        field->sensor = change->field.sensor;
    if (!apply_sensors(change, field, error) || !find_baseline(context, change, field, error))
        return false;
    if (!field_params_placed(context->scene->plant, field)) {
        message_refuse(error, "bad_field", "sensors", REFUSAL_PLACELESS);
        return false;
    }
    const char *wrong = field_params_wrong(context->scene->plant, field);
    if (wrong) {
        message_fail(error, "bad_field", "%s", wrong);
        return false;
    }
    if (!may_show(context->scene->plant, field, error))
        return false;
    take_quantity(context, &before->field, view);
    return true;
}

void params_apply_baseline(const struct params_context *context, const struct params_change *change, struct view *view)
{
    if (change->baseline == BASELINE_NOW)
        view->field.baseline = baselines_keep(context->baselines, context->snapshot);
    if (change->baseline == BASELINE_SET)
        view->field.baseline = baselines_set(context->baselines, change->baseline_name, context->snapshot);
    if (change->baseline == BASELINE_REMOVE)
        baselines_remove(context->baselines, change->baseline_name);
}
