/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clients/web/core/address.js reads the same. */
#include "view_address.h"

#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "message/view_address.h"
#include "message/view_query.h"
#include "scene/visibility.h"

/* Of several of one name the first counts. */
static bool take_field(void *arg, const char *name, char *value)
{
    if (!json_object_get(arg, name))
        json_object_set_new(arg, name, json_string(value));
    return true;
}

static json_t *fields_of(const char *address)
{
    json_t *fields = json_object();
    view_address_each(address + (*address == '#'), take_field, fields);
    return fields;
}

static const char *field_of(const json_t *fields, const char *name)
{
    return json_string_value(json_object_get(fields, name));
}

/* As an argument of that name of a query. NULL: it is not there, or has another form. */
static json_t *value_of(const json_t *fields, const char *name, const char *of_query)
{
    const char *text = field_of(fields, name);
    return text ? view_query_value(of_query, text) : NULL;
}

/* NULL: it is no list of numbers, or not so many (0: any). */
static json_t *numbers_of(const json_t *fields, const char *name, size_t count)
{
    json_t *list = value_of(fields, name, name);
    if (json_is_array(list) && (count == 0 || json_array_size(list) == count))
        return list;
    json_decref(list);
    return NULL;
}

static double at(const json_t *list, size_t index)
{
    return json_number_value(json_array_get(list, index));
}

static json_t *name_list(const char *text)
{
    json_t *list = json_array();
    char *copy = mem_strdup(text), *rest = copy;
    for (char *name = strtok_r(copy, ",", &rest); name; name = strtok_r(NULL, ",", &rest))
        json_array_append_new(list, json_string(name));
    mem_free(copy);
    return list;
}

static bool is_one_of(const char *text, const char *choices) /* with blanks around each; "": any */
{
    char padded[64];
    snprintf(padded, sizeof(padded), " %.60s ", text);
    return text[0] && (!choices[0] || (!strchr(text, ' ') && strstr(choices, padded)));
}

static void take_names(const json_t *fields, json_t *params)
{
    static const char *const choices[][2] = {
        { "group", "" },
        { "interpolation", "" },
        { "distance", " geodesic euclidean " },
        { "colormap", "" },
        { "look", " default glossy flat materials " },
        { "fill", " none neighbours " },
        { "scale", " linear log " },
        { "show", " value operator distance " },
        { "sensor", "" },
        { "environment", "" },
    };
    for (size_t i = 0; i < sizeof(choices) / sizeof(choices[0]); i++) {
        const char *value = field_of(fields, choices[i][0]);
        if (value && is_one_of(value, choices[i][1]))
            json_object_set_new(params, choices[i][0], json_string(value));
    }
    const char *show = field_of(fields, "show"), *baseline = field_of(fields, "baseline");
    if (show && baseline && baseline[0] && !strcmp(show, "difference"))
        json_object_update_new(params, json_pack("{s:s,s:s}", "show", show, "baseline", baseline));
}

static void take_numbers(const json_t *fields, json_t *params)
{
    static const struct {
        const char *name;
        size_t count; /* 0: any */
    } lists[] = { { "range", 2 }, { "light", 3 }, { "breaks", 0 }, { "isolines", 0 } };
    static const char *const factors[][2] = {
        { "ramp", "ramp_interval" }, { "strength", "strength" }, { "decay", "decay" },
        { "power", "power" },        { "radius", "radius_m" },   { "reach", "reach_m" },
    };
    for (size_t i = 0; i < sizeof(lists) / sizeof(lists[0]); i++) {
        json_t *list = numbers_of(fields, lists[i].name, lists[i].count);
        bool good = list != NULL;
        if (good && !strcmp(lists[i].name, "light"))
            good = at(list, 0) != 0 || at(list, 1) != 0 || at(list, 2) != 0;
        if (good && !strcmp(lists[i].name, "range"))
            good = at(list, 0) < at(list, 1);
        if (good)
            json_object_set(params, lists[i].name, list);
        json_decref(list);
    }
    for (size_t i = 0; i < sizeof(factors) / sizeof(factors[0]); i++) {
        json_t *value = value_of(fields, factors[i][0], factors[i][1]);
        if (value && json_number_value(value) >= 0)
            json_object_set(params, factors[i][1], value);
        json_decref(value);
    }
}

/* TAG=STRENGTH[:DECAY],...; none of it where some of it is invalid. */
static void take_sensors(const json_t *fields, json_t *params)
{
    json_t *sensors = value_of(fields, "sensors", "sensors"), *own, *factor;
    const char *tag, *name;
    bool good = json_object_size(sensors) > 0 && !json_object_get(sensors, "");
    json_object_foreach(sensors, tag, own) json_object_foreach(own, name, factor) good =
        good && json_number_value(factor) >= 0 && json_number_value(factor) <= 100;
    if (good)
        json_object_set(params, "sensors", sensors);
    json_decref(sensors);
}

static void take_sets(const json_t *fields, json_t *params)
{
    static const char *const sets[][2] = { { "hide", "hidden" }, { "only", "isolate" }, { "ghost", "ghost" } };
    for (size_t i = 0; i < sizeof(sets) / sizeof(sets[0]); i++) {
        const char *value = field_of(fields, sets[i][0]);
        if (value)
            json_object_set_new(params, sets[i][1], name_list(value));
    }
    const char *asset = field_of(fields, "asset");
    if (asset && asset[0])
        json_object_set_new(params, "selected", json_string(asset));
}

/* group:pressure;look:flat */
static void take_split(const json_t *fields, json_t *params)
{
    static const char half[] = " group show distance interpolation colormap look ";
    const char *value = field_of(fields, "split");
    if (!value || !value[0])
        return;
    json_t *split = json_object();
    char *copy = mem_strdup(value), *rest = copy;
    for (char *pair = strtok_r(copy, ";", &rest); pair; pair = strtok_r(NULL, ";", &rest)) {
        char *colon = strchr(pair, ':');
        if (!colon || !colon[1])
            continue;
        *colon = 0;
        if (is_one_of(pair, half))
            json_object_set_new(split, pair, json_string(colon + 1));
    }
    mem_free(copy);
    json_object_set_new(params, "split", split);
}

/* Planes of four numbers, or one list of six: a box. */
static void take_clip(const json_t *fields, json_t *params)
{
    json_t *clip = value_of(fields, "clip", "clip_box");
    if (!clip)
        clip = value_of(fields, "clip", "clip");
    const json_t *planes = json_object_get(clip, "planes");
    bool good = json_object_get(clip, "box") || (json_array_size(planes) > 0 && json_array_size(planes) <= CLIP_MAX_PLANES);
    for (size_t i = 0; i < json_array_size(planes); i++)
        good = good && json_array_size(json_array_get(planes, i)) == 4;
    if (good)
        json_object_set(params, "clip", clip);
    json_decref(clip);
}

json_t *view_address_params(const char *text)
{
    json_t *params = json_object(), *fields = fields_of(text);
    take_names(fields, params);
    take_numbers(fields, params);
    take_sensors(fields, params);
    take_sets(fields, params);
    take_split(fields, params);
    take_clip(fields, params);
    json_decref(fields);
    return params;
}

static void copy_vector(const json_t *list, size_t first, double out[3])
{
    for (size_t i = 0; i < 3; i++)
        out[i] = at(list, first + i);
}

static json_t *vector_of(const double v[3])
{
    return json_pack("[f,f,f]", v[0], v[1], v[2]);
}

json_t *view_address_camera_message(const struct camera *camera)
{
    json_t *o =
        json_pack("{s:o,s:o,s:o}", "eye", vector_of(camera->eye_m), "target", vector_of(camera->target_m), "up", vector_of(camera->up));
    if (camera->height_m > 0)
        json_object_update_new(o, json_pack("{s:s,s:f}", "projection", "orthographic", "height_m", camera->height_m));
    else
        json_object_set_new(o, "fov", json_real(camera->fov_deg));
    return o;
}

json_t *view_address_camera(const char *text)
{
    json_t *fields = fields_of(text), *list = numbers_of(fields, "camera", 0), *o = NULL;
    size_t count = json_array_size(list);
    struct camera camera = { .fov_deg = at(list, 9), .height_m = at(list, 10) };
    copy_vector(list, 0, camera.eye_m);
    copy_vector(list, 3, camera.target_m);
    copy_vector(list, 6, camera.up);
    if ((count == 10 || (count == 11 && camera.height_m > 0)) && camera_valid(&camera))
        o = view_address_camera_message(&camera);
    json_decref(list);
    json_decref(fields);
    return o;
}
