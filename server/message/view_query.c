/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts a query of /snapshot.png to the JSON of the messages `camera` and `params`, so that the same code checks queries and
   messages. */
#include "message/view_query.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/timestamp.h"
#include "history/history.h"
#include "message/json_fields.h"
#include "message/fit_message.h"

enum query_kind { NUMBER, NUMBER_OR_NONE, STRING, NUMBERS, SENSORS, BREAKS, LINES, SPLIT, STRINGS, PLANES, BOX };

static const struct {
    const char *name;
    enum query_kind kind;
} known[] = {
    { "width", NUMBER },
    { "height", NUMBER },
    { "camera", NUMBERS },
    { "up", NUMBERS },
    { "group", STRING },
    { "interpolation", STRING },
    { "distance", STRING },
    { "fill", STRING },
    { "strength", NUMBER },
    { "decay", NUMBER },
    { "power", NUMBER },
    { "radius_m", NUMBER },
    { "reach_m", NUMBER_OR_NONE },
    { "colormap", STRING },
    { "ramp_interval", NUMBER },
    { "range", NUMBERS },
    { "look", STRING },
    { "light", NUMBERS },
    { "selected", STRING },
    { "show", STRING },
    { "sensor", STRING },
    { "environment", STRING },
    { "backdrop", STRING },
    { "strip", STRING },
    { "language", STRING },
    { "arrows", STRING },
    { "sensors", SENSORS },
    { "baseline", STRING },
    { "scale", STRING },
    { "breaks", BREAKS },
    { "isolines", LINES },
    { "split", SPLIT },
    { "projection", STRING },
    { "height_m", NUMBER },
    { "fit", STRING },
    { "side", STRING },
    { "hidden", STRINGS },
    { "isolate", STRINGS },
    { "ghost", STRINGS },
    { "clip", PLANES },
    { "clip_box", BOX },
    { "x", NUMBER },
    { "y", NUMBER },
    { "at", STRING },
};

/* Reads a number at the start of `text` and sets *end to just after it. Returns NULL if there is no number. */
static json_t *number(const char *text, const char **end)
{
    char *stop;
    double value = strtod(text, &stop);
    *end = stop;
    return stop == text ? NULL : json_real(value);
}

static json_t *numbers(const char *text)
{
    json_t *array = json_array(), *item;
    const char *end = "";
    while ((item = number(text, &end))) {
        json_array_append_new(array, item);
        if (*end != ',')
            break;
        text = end + 1;
    }
    if (item && *end == 0)
        return array;
    json_decref(array);
    return NULL;
}

/* Reads one sensor's strength (factor of its weight) and decay (how fast its weight falls with distance): `STRENGTH`,
   `STRENGTH:DECAY` or `:DECAY`, such as `2:0.5`. */
static json_t *sensor(const char *text)
{
    json_t *object = json_object();
    const char *end = text;
    json_t *strength = *text == ':' ? NULL : number(text, &end);
    bool two = *end == ':';
    json_t *decay = two ? number(end + 1, &end) : NULL;
    bool good = (strength || *text == ':') && (decay || !two) && *end == 0;
    if (strength)
        json_object_set_new(object, "strength", strength);
    if (decay)
        json_object_set_new(object, "decay", decay);
    if (good)
        return object;
    json_decref(object);
    return NULL;
}

/* Reads the strengths (factors of the weights) and decays (how fast the weights fall with distance) of several sensors:
   TAG=STRENGTH[:DECAY],... */
static json_t *sensors(const char *text)
{
    json_t *all = json_object();
    char *copy = mem_strdup(text), *rest = copy;
    bool good = true;
    for (char *item; good && (item = strsep(&rest, ","));) {
        char *equals = strrchr(item, '=');
        json_t *one = equals ? sensor(equals + 1) : NULL;
        if (equals)
            *equals = 0;
        good = one && json_object_set_new(all, item, one) == 0;
    }
    mem_free(copy);
    if (good)
        return all;
    json_decref(all);
    return NULL;
}

/* Reads the breaks of a colour scale: a name, or numbers. */
static json_t *breaks(const char *text)
{
    if (!strcmp(text, "none"))
        return json_null();
    return !strcmp(text, "group") || !strcmp(text, "limits") ? json_string(text) : numbers(text);
}

/* Reads the values of isolines: numbers, or `every:STEP`. */
static json_t *lines(const char *text)
{
    const char *end = "";
    if (!strcmp(text, "none"))
        return json_null();
    if (strncmp(text, "every:", 6) != 0)
        return numbers(text);
    json_t *step = number(text + 6, &end);
    if (step && *end == 0)
        return step;
    json_decref(step);
    return NULL;
}

static bool add_argument(json_t *o, const char *arg, struct message_error *error);

/* Reads the argument `split` of a query: parameters of the right half of a split view (two pictures side by side), as
   NAME=VALUE;... */
static json_t *split(const char *text, struct message_error *error)
{
    json_t *all = json_object();
    char *copy = mem_strdup(text), *rest = copy;
    bool good = true;
    for (char *item; good && (item = strsep(&rest, ";"));)
        good = !*item || add_argument(all, item, error);
    mem_free(copy);
    if (good)
        return all;
    json_decref(all);
    return NULL;
}

/* Reads texts separated by commas. */
static json_t *strings(const char *text)
{
    json_t *array = json_array();
    for (size_t n; *text; text += n + (text[n] == ',')) {
        n = strcspn(text, ",");
        json_array_append_new(array, json_stringn(text, n));
    }
    return array;
}

/* Reads the clipping planes: four numbers each, separated by semicolons. Returns NULL if the text is anything else. */
static json_t *planes(const char *text)
{
    json_t *array = json_array();
    for (size_t n; *text; text += n + (text[n] == ';')) {
        char *one = strndup(text, n = strcspn(text, ";"));
        json_t *plane = numbers(one);
        free(one);
        json_array_append_new(array, plane ? plane : json_null());
    }
    return json_pack("{s:o}", "planes", array);
}

static json_t *box(const char *text)
{
    json_t *array = numbers(text);
    double n[6];
    bool good = json_array_size(array) == 6;
    for (size_t i = 0; i < 6 && good; i++)
        n[i] = json_number_value(json_array_get(array, i));
    json_decref(array);
    return good ? json_pack("{s:{s:[f,f,f],s:[f,f,f]}}", "box", "min", n[0], n[1], n[2], "max", n[3], n[4], n[5]) : NULL;
}

static json_t *value_of(enum query_kind kind, const char *text, struct message_error *error)
{
    const char *end = "";
    json_t *value;
    switch (kind) {
    case STRING: return json_string(text);
    case NUMBERS: return numbers(text);
    case SENSORS: return sensors(text);
    case BREAKS: return breaks(text);
    case LINES: return lines(text);
    case SPLIT: return split(text, error);
    case STRINGS: return strings(text);
    case PLANES: return planes(text);
    case BOX: return box(text);
    case NUMBER_OR_NONE:
        if (!strcmp(text, "none"))
            return json_null();
        /* fall through */
    case NUMBER:
        value = number(text, &end);
        if (value && *end == 0)
            return value;
        json_decref(value);
    }
    return NULL;
}

static bool add_argument(json_t *o, const char *arg, struct message_error *error)
{
    size_t n = strcspn(arg, "=");
    char name[48];
    for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); i++) {
        if (strlen(known[i].name) != n || strncmp(known[i].name, arg, n) != 0)
            continue;
        static const char *const expected[] = { "a number",
                                                "a number, or none",
                                                "a text",
                                                "numbers separated by commas",
                                                "TAG=STRENGTH[:DECAY], separated by commas",
                                                "numbers separated by commas, or group, limits or none",
                                                "numbers separated by commas, or every:STEP, or none",
                                                "NAME=VALUE, separated by semicolons",
                                                "ids separated by commas",
                                                "planes as nx,ny,nz,d, separated by semicolons",
                                                "the corners min and max: six numbers separated by commas" };
        struct message_error inner = { .code = NULL };
        json_t *value = arg[n] == '=' ? value_of(known[i].kind, arg + n + 1, &inner) : NULL;
        if (value)
            return json_object_set_new(o, known[i].kind == BOX ? "clip" : known[i].name, value) == 0;
        if (!inner.code)
            message_fail(&inner, "bad_field", "%s expected", expected[known[i].kind]);
        *error = inner;
        message_error_within(error, known[i].name);
        return false;
    }
    message_refuse_with(error, "bad_field", NULL, REFUSAL_UNKNOWN, "name=%s", quoted(arg, name));
    return false;
}

static bool apply_at(const struct params_context *context, const json_t *o, struct view *view, struct message_error *error)
{
    const char *text = json_string_value(json_object_get(o, "at"));
    int64_t at_us = 0;
    if (!text)
        return true;
    if (!timestamp_parse(text, context->now_us, &at_us) || at_us <= 0) {
        char found[48];
        message_fail(error, "bad_field", "at: expected " TIMESTAMP_FORMS ", found '%s'", quoted(text, found));
        return false;
    }
    if (at_us > context->now_us - HISTORY_SETTLED_US) {
        message_fail(error, "bad_field", "at: expected a time at least 3 s ago; for a current picture, omit the argument `at`");
        return false;
    }
    view_set_instant(view, at_us, 0);
    return true;
}

static bool apply(const struct params_context *context, enum role role, const json_t *o, struct view *view, struct message_error *error)
{
    double w = 1280, h = 720;
    struct message asked = { .type = MESSAGE_PARAMS };
    struct plant copy;
    const struct plant *plant = role_plant(role, context->scene->plant, &copy);
    if (!may_number(o, "width", 16, VIEW_MAX_SIDE_PX, &w, NULL, error) || !may_number(o, "height", 16, VIEW_MAX_SIDE_PX, &h, NULL, error))
        return false;
    if (!view_size_valid(w, h)) {
        message_fail(error, "bad_field", "width, height: expected whole numbers, and at most %d pixels in the picture", VIEW_MAX_PIXELS);
        return false;
    }
    view_default(context->scene, (int)w, (int)h, view);
    view->tier = TIER_REFINED;
    return params_parse(plant, o, &asked.params, error) && split_parse(plant, o, &asked.split, error) &&
           role_may_send(role, &asked, error) && params_apply(context, &asked.params, view, error) &&
           split_apply(context, &asked.split, view, error) && view_query_camera(context->scene, plant, o, context->bare, view, error) &&
           apply_at(context, o, view, error);
}

bool view_query_parse(const struct params_context *context, enum role role, const char *const *args, size_t count, struct view *view,
                      double place[2], struct message_error *error)
{
    json_t *o = json_object();
    bool good = true;
    for (size_t i = 0; i < count && good; i++)
        good = add_argument(o, args[i], error);
    if (good && !place && (json_object_get(o, "x") || json_object_get(o, "y"))) {
        message_fail(error, "bad_field", "x, y: allowed only in a request for the value at a pixel");
        good = false;
    }
    good = good && (!place || (need_number(o, "x", 0, VIEW_MAX_SIDE_PX, &place[0], error) &&
                               need_number(o, "y", 0, VIEW_MAX_SIDE_PX, &place[1], error)));
    good = good && apply(context, role, o, view, error);
    json_decref(o);
    return good;
}
