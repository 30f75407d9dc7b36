/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clients/web/core/address.js reads the same. */
#include "view_address.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "scene/camera.h"
#include "scene/visibility.h"

enum { MOST_NUMBERS = 64 };

static int hex(char c)
{
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/* The value of a field, with %41 and + undone; NULL: it is not there. The caller frees it. */
static char *field_of(const char *text, const char *name)
{
    size_t length = strlen(name);
    for (text += *text == '#'; *text; text += strcspn(text, "&"), text += *text == '&') {
        if (strncmp(text, name, length) != 0 || text[length] != '=')
            continue;
        size_t count = strcspn(text, "&") - length - 1, n = 0;
        const char *from = text + length + 1;
        char *value = mem_array(count + 1, 1);
        for (size_t i = 0; i < count; i++) {
            bool escaped = from[i] == '%' && i + 2 < count && hex(from[i + 1]) >= 0 && hex(from[i + 2]) >= 0;
            value[n++] = escaped ? (char)(hex(from[i + 1]) * 16 + hex(from[i + 2])) : from[i] == '+' ? ' ' : from[i];
            i += escaped ? 2 : 0;
        }
        return value;
    }
    return NULL;
}

static bool read_number(const char *text, char **end, double *out)
{
    *out = strtod(text, end);
    return *end > text && isfinite(*out) && !strchr("xXnNiI", text[text[0] == '-']);
}

/* Numbers with commas between them. Returns how many; -1: it is no such list. */
static int read_numbers(const char *text, double *out)
{
    int count = 0;
    char *end;
    while (text && count < MOST_NUMBERS && read_number(text, &end, &out[count])) {
        count++;
        if (!*end)
            return count;
        if (*end != ',')
            return -1;
        text = end + 1;
    }
    return -1;
}

static json_t *number_list(const double *at, int count)
{
    json_t *list = json_array();
    for (int i = 0; i < count; i++)
        json_array_append_new(list, json_real(at[i]));
    return list;
}

static json_t *name_list(char *text)
{
    json_t *list = json_array();
    char *rest = text;
    for (char *name = strtok_r(text, ",", &rest); name; name = strtok_r(NULL, ",", &rest))
        json_array_append_new(list, json_string(name));
    return list;
}

static bool is_one_of(const char *text, const char *choices) /* with blanks around each; "": any */
{
    char padded[64];
    snprintf(padded, sizeof(padded), " %.60s ", text);
    return text[0] && (!choices[0] || (!strchr(text, ' ') && strstr(choices, padded)));
}

static void take_names(const char *text, json_t *params)
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
        char *value = field_of(text, choices[i][0]);
        if (value && is_one_of(value, choices[i][1]))
            json_object_set_new(params, choices[i][0], json_string(value));
        mem_free(value);
    }
    char *show = field_of(text, "show"), *baseline = field_of(text, "baseline");
    if (show && baseline && baseline[0] && !strcmp(show, "difference")) {
        json_object_set_new(params, "show", json_string(show));
        json_object_set_new(params, "baseline", json_string(baseline));
    }
    mem_free(show);
    mem_free(baseline);
}

static void take_numbers(const char *text, json_t *params)
{
    static const struct {
        const char *name;
        int count; /* 0: any */
    } lists[] = { { "range", 2 }, { "light", 3 }, { "breaks", 0 }, { "isolines", 0 } };
    double at[MOST_NUMBERS];
    for (size_t i = 0; i < sizeof(lists) / sizeof(lists[0]); i++) {
        char *value = field_of(text, lists[i].name);
        int count = read_numbers(value, at);
        bool good = count > 0 && (!lists[i].count || count == lists[i].count);
        if (good && !strcmp(lists[i].name, "light"))
            good = at[0] != 0 || at[1] != 0 || at[2] != 0;
        if (good && !strcmp(lists[i].name, "range"))
            good = at[0] < at[1];
        if (good)
            json_object_set_new(params, lists[i].name, number_list(at, count));
        mem_free(value);
    }
    char *ramp = field_of(text, "ramp");
    if (read_numbers(ramp, at) == 1 && at[0] >= 0)
        json_object_set_new(params, "ramp_interval", json_real(at[0]));
    mem_free(ramp);
}

static void take_sets(const char *text, json_t *params)
{
    static const char *const sets[][2] = { { "hide", "hidden" }, { "only", "isolate" }, { "ghost", "ghost" } };
    for (size_t i = 0; i < sizeof(sets) / sizeof(sets[0]); i++) {
        char *value = field_of(text, sets[i][0]);
        if (value)
            json_object_set_new(params, sets[i][1], name_list(value));
        mem_free(value);
    }
    char *asset = field_of(text, "asset");
    if (asset && asset[0])
        json_object_set_new(params, "selected", json_string(asset));
    mem_free(asset);
}

/* group:pressure;look:flat */
static void take_split(const char *text, json_t *params)
{
    static const char half[] = " group show distance interpolation colormap look ";
    char *value = field_of(text, "split"), *rest = value;
    if (value && value[0]) {
        json_t *split = json_object();
        for (char *pair = strtok_r(value, ";", &rest); pair; pair = strtok_r(NULL, ";", &rest)) {
            char *colon = strchr(pair, ':');
            if (!colon || !colon[1])
                continue;
            *colon = 0;
            if (is_one_of(pair, half))
                json_object_set_new(split, pair, json_string(colon + 1));
        }
        json_object_set_new(params, "split", split);
    }
    mem_free(value);
}

/* Planes of four numbers, or one list of six: a box. */
static void take_clip(const char *text, json_t *params)
{
    char *value = field_of(text, "clip"), *rest = value;
    json_t *planes = json_array();
    double at[MOST_NUMBERS];
    bool good = value && value[0], is_box = false;
    for (char *part = good ? strtok_r(value, ";", &rest) : NULL; part && good; part = strtok_r(NULL, ";", &rest)) {
        int count = read_numbers(part, at);
        is_box = count == 6 && json_array_size(planes) == 0;
        good = (count == 4 || is_box) && json_array_size(planes) < CLIP_MAX_PLANES;
        json_array_append_new(planes, number_list(at, count > 0 ? count : 0));
    }
    if (good && is_box && json_array_size(planes) == 1)
        json_object_set_new(params, "clip", json_pack("{s:{s:o,s:o}}", "box", "min", number_list(at, 3), "max", number_list(at + 3, 3)));
    else if (good && !is_box)
        json_object_set_new(params, "clip", json_pack("{s:O}", "planes", planes));
    json_decref(planes);
    mem_free(value);
}

json_t *view_address_params(const char *text)
{
    json_t *params = json_object();
    take_names(text, params);
    take_numbers(text, params);
    take_sets(text, params);
    take_split(text, params);
    take_clip(text, params);
    return params;
}

json_t *view_address_camera(const char *text)
{
    double at[MOST_NUMBERS];
    char *value = field_of(text, "camera");
    int count = read_numbers(value, at);
    mem_free(value);
    if (count != 10 && count != 11)
        return NULL;
    struct camera camera = { .fov_deg = at[9], .height_m = count == 11 ? at[10] : 0 };
    memcpy(camera.eye_m, at, sizeof(camera.eye_m));
    memcpy(camera.target_m, at + 3, sizeof(camera.target_m));
    memcpy(camera.up, at + 6, sizeof(camera.up));
    if ((count == 11 && at[10] <= 0) || !camera_valid(&camera))
        return NULL;
    json_t *o = json_pack("{s:o,s:o,s:o}", "eye", number_list(at, 3), "target", number_list(at + 3, 3), "up", number_list(at + 6, 3));
    if (count == 11)
        json_object_update_new(o, json_pack("{s:s,s:f}", "projection", "orthographic", "height_m", at[10]));
    else
        json_object_set_new(o, "fov", json_real(at[9]));
    return o;
}
