/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parameters that a client may choose: parses them and applies them to a view. */
#include <math.h>
#include <string.h>

#include "message/json_fields.h"
#include "message/visibility.h"
#include "plant/colormaps.h"

static const double NUMBER_MAX = 1e12;

/* Refuses a message's member `field` because the plant has no item with the name in its value. Always returns false. */
static bool refuse_name(const char *field, const json_t *value, enum refusal_code code, struct message_error *error)
{
    char name[48];
    message_refuse_with(error, "bad_field", field, code, "name=%s",
                        json_is_string(value) ? quoted(json_string_value(value), name) : "(not a text)");
    return false;
}

/* a member of the message `params` whose value is the name of an item of the plant file, such as a group */
struct name_field {
    const char *field;
    int (*find)(const struct plant *plant, const char *name);
    enum refusal_code unknown; /* code of the refusal if find() does not know the name */
    unsigned bit;              /* marks the field as given */
};

static const struct name_field GROUP = { "group", plant_find_group, REFUSAL_NO_GROUP, GIVEN_GROUP };
static const struct name_field COLORMAP = { "colormap", colormap_find, REFUSAL_UNKNOWN, GIVEN_COLORMAP };
static const struct name_field ENVIRONMENT = { "environment", plant_find_environment, REFUSAL_UNKNOWN, GIVEN_ENVIRONMENT };

/* Reads a member of the message whose value is the name of an item of the plant file. *index receives the item's index. */
static bool parse_name(const struct plant *plant, const json_t *o, const struct name_field *name, int *index, struct params_change *out,
                       struct message_error *error)
{
    const json_t *value = json_object_get(o, name->field);
    if (!value)
        return true;
    if (!json_is_string(value) || (*index = name->find(plant, json_string_value(value))) < 0)
        return refuse_name(name->field, value, name->unknown, error);
    out->given |= name->bit;
    return true;
}

static bool parse_names(const json_t *o, struct params_change *out, struct message_error *error)
{
    struct {
        const char *field;
        const struct name *names;
        unsigned bit;
        int value;
    } all[] = {
        { "interpolation", names_interpolation, GIVEN_INTERPOLATION, 0 },
        { "distance", names_distance, GIVEN_DISTANCE, 0 },
        { "fill", names_fill, GIVEN_FILL, 0 },
        { "look", names_look, GIVEN_LOOK, 0 },
        { "backdrop", names_backdrop, GIVEN_BACKDROP, 0 },
        { "strip", names_strip, GIVEN_STRIP, 0 },
        { "arrows", names_arrows, GIVEN_ARROWS, 0 },
        { "language", names_language, GIVEN_LANGUAGE, 0 },
    };
    for (size_t i = 0; i < sizeof(all) / sizeof(all[0]); i++) {
        bool given;
        if (!may_name(o, all[i].field, all[i].names, &all[i].value, &given, error))
            return false;
        out->given |= given ? all[i].bit : 0;
    }
    out->field.interpolation = (enum interpolation)all[0].value;
    out->field.distance = (enum distance_mode)all[1].value;
    out->field.fill = (enum fill_mode)all[2].value;
    out->look = (enum look)all[3].value;
    out->dark = all[4].value;
    out->strip = all[5].value;
    out->directions = (enum directions_look)all[6].value;
    out->language = (enum language)all[7].value;
    return true;
}

static bool parse_numbers(const json_t *o, struct params_change *out, struct message_error *error)
{
    struct {
        const char *field;
        double low, high, *to;
        unsigned bit;
    } all[] = {
        { "strength", 0, 100, &out->field.strength, GIVEN_STRENGTH },
        { "decay", 0, 100, &out->field.decay, GIVEN_DECAY },
        { "power", 0.5, 16, &out->field.power, GIVEN_POWER },
        { "radius_m", 0, 1e6, &out->field.radius_m, GIVEN_RADIUS },
        { "ramp_interval", 0, NUMBER_MAX, &out->ramp_interval, GIVEN_RAMP },
    };
    for (size_t i = 0; i < sizeof(all) / sizeof(all[0]); i++) {
        bool given;
        if (!may_number(o, all[i].field, all[i].low, all[i].high, all[i].to, &given, error))
            return false;
        out->given |= given ? all[i].bit : 0;
    }
    return true;
}

static bool parse_reach(const json_t *o, struct params_change *out, struct message_error *error)
{
    const json_t *value = json_object_get(o, "reach_m");
    if (!value)
        return true;
    out->given |= GIVEN_REACH;
    out->field.reach_m = INFINITY;
    if (json_is_null(value))
        return true;
    return may_number(o, "reach_m", 1e-6, 1e6, &out->field.reach_m, NULL, error);
}

static bool parse_range(const json_t *o, struct params_change *out, struct message_error *error)
{
    const json_t *value = json_object_get(o, "range");
    if (!value)
        return true;
    out->given |= GIVEN_RANGE;
    out->range_of_group = json_is_null(value);
    if (out->range_of_group)
        return true;
    const json_t *low = json_array_get(value, 0), *high = json_array_get(value, 1);
    out->range_min = json_number_value(low);
    out->range_max = json_number_value(high);
    bool numbers = json_array_size(value) == 2 && json_is_number(low) && json_is_number(high);
    if (!numbers || !(out->range_max > out->range_min))
        message_refuse(error, "bad_field", "range", REFUSAL_RANGE);
    else if (!(fabs(out->range_min) <= NUMBER_MAX && fabs(out->range_max) <= NUMBER_MAX))
        message_refuse_with(error, "bad_field", "range", REFUSAL_BETWEEN, "low=%g\nhigh=%g", -NUMBER_MAX, NUMBER_MAX);
    else if (!plant_range_is_wide(out->range_min, out->range_max))
        message_refuse(error, "bad_field", "range", REFUSAL_RANGE);
    else
        return true;
    return false;
}

static bool parse_selected(const struct plant *plant, const json_t *o, struct params_change *out, struct message_error *error)
{
    const json_t *value = json_object_get(o, "selected");
    if (!value)
        return true;
    out->given |= GIVEN_SELECTED;
    out->selected_asset = -1;
    if (json_is_null(value))
        return true;
    if (!json_is_string(value) || (out->selected_asset = plant_find_asset(plant, json_string_value(value))) < 0)
        return refuse_name("selected", value, REFUSAL_NO_ASSET, error);
    return true;
}

static bool parse_light(const json_t *o, struct params_change *out, struct message_error *error)
{
    bool given;
    double *l = out->light_dir;
    out->light_of_plant = json_is_null(json_object_get(o, "light"));
    if (out->light_of_plant) {
        out->given |= GIVEN_LIGHT;
        return true;
    }
    if (!may_vector(o, "light", l, &given, error))
        return false;
    if (!given)
        return true;
    double length = sqrt(l[0] * l[0] + l[1] * l[1] + l[2] * l[2]);
    if (length < 1e-6) {
        message_fail(error, "bad_field", "light: expected a direction, but all three numbers are 0");
        return false;
    }
    for (int i = 0; i < 3; i++)
        l[i] /= length;
    out->given |= GIVEN_LIGHT;
    return true;
}

bool params_parse(const struct plant *plant, const json_t *o, struct params_change *out, struct message_error *error)
{
    *out = (struct params_change){ .selected_asset = -1 };
    return parse_name(plant, o, &GROUP, &out->field.group, out, error) && parse_names(o, out, error) && parse_numbers(o, out, error) &&
           parse_reach(o, out, error) && parse_range(o, out, error) && parse_name(plant, o, &COLORMAP, &out->colormap, out, error) &&
           parse_selected(plant, o, out, error) && parse_light(o, out, error) &&
           parse_name(plant, o, &ENVIRONMENT, &out->environment, out, error) && params_parse_show(plant, o, out, error) &&
           params_parse_paint(o, out, error) && visibility_parse(plant, o, out, error);
}

/* Changes the group (quantity) that a view shows, and sets that group's default parameters. If the view shows values relative
   to alarm limits (SHOW_OPERATOR), it continues to do so. */
static void take_group(const struct scene *scene, int group, bool is_operator, struct view *view)
{
    field_params_default(scene->plant, group, &view->field);
    field_params_set_show(scene->plant, &view->field, is_operator ? SHOW_OPERATOR : SHOW_VALUE);
    view_default_scale(scene, view);
}

static void apply_field(const struct params_change *change, struct field_params *field)
{
    if (change->given & GIVEN_INTERPOLATION)
        field->interpolation = change->field.interpolation;
    if (change->given & GIVEN_DISTANCE)
        field->distance = change->field.distance;
    if (change->given & GIVEN_FILL)
        field->fill = change->field.fill;
    if (change->given & GIVEN_STRENGTH)
        field->strength = change->field.strength;
    if (change->given & GIVEN_DECAY)
        field->decay = change->field.decay;
    if (change->given & GIVEN_POWER)
        field->power = change->field.power;
    if (change->given & GIVEN_RADIUS)
        field->radius_m = change->field.radius_m;
    if (change->given & GIVEN_REACH)
        field->reach_m = change->field.reach_m;
}

static void apply_look(const struct scene *scene, const struct params_change *change, struct view *view)
{
    if (change->given & GIVEN_COLORMAP)
        view->colormap = change->colormap;
    if (change->given & GIVEN_RAMP)
        view->ramp_interval = change->ramp_interval;
    if ((change->given & GIVEN_RANGE) && change->range_of_group) {
        field_default_range(scene, &view->field, &view->range_min, &view->range_max);
    } else if (change->given & GIVEN_RANGE) {
        view->range_min = change->range_min;
        view->range_max = change->range_max;
    }
    if (change->given & GIVEN_LOOK)
        view->look = change->look;
    if (change->given & GIVEN_BACKDROP)
        view->dark = change->dark;
    if (change->given & GIVEN_STRIP)
        view->strip = change->strip;
    if (change->given & GIVEN_LANGUAGE)
        view->language = change->language;
    if (change->given & GIVEN_ARROWS)
        view->directions = change->directions;
    if ((change->given & GIVEN_LIGHT) && change->light_of_plant)
        view_default_light(scene, view->light_dir);
    else if (change->given & GIVEN_LIGHT)
        memcpy(view->light_dir, change->light_dir, sizeof(view->light_dir));
    if (change->given & GIVEN_ENVIRONMENT)
        view->environment = change->environment;
    if (change->given & GIVEN_SELECTED)
        view->selected_asset = change->selected_asset;
    visibility_apply(change, &view->visibility);
}

bool params_apply(const struct params_context *context, const struct params_change *change, struct view *view, struct message_error *error)
{
    struct view changed = *view;
    if ((change->given & GIVEN_GROUP) && change->field.group != changed.field.group)
        take_group(context->scene, change->field.group, view_is_operator(view), &changed);
    apply_field(change, &changed.field);
    if (!params_apply_show(context, change, view, &changed, error))
        return false;
    apply_look(context->scene, change, &changed);
    if (!params_apply_paint(context->scene->plant, change, &changed, error))
        return false;
    params_apply_baseline(context, change, &changed);
    *view = changed;
    return true;
}
