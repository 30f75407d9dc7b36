/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Translates the fields of the page's URL (clients/web/core/address.js) into the arguments of an HTTP query for the same picture. */
#include "message/view_address.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

/* number of comma-separated values of a camera in a URL: 3 each for eye, target and up, then the angle, and the height of a
   parallel projection */
enum { CAMERA_NUMBERS = 11 };

static const struct {
    /* name: field in the page's URL; of_query: argument of an HTTP query with the same meaning; NULL: no argument corresponds,
       so the field is dropped */
    const char *name, *of_query;
} names[] = {
    { "group", "group" },
    { "interpolation", "interpolation" },
    { "distance", "distance" },
    { "colormap", "colormap" },
    { "look", "look" },
    { "fill", "fill" },
    { "scale", "scale" },
    { "show", "show" },
    { "arrows", "arrows" },
    { "sensor", "sensor" },
    { "environment", "environment" },
    { "baseline", "baseline" },
    { "range", "range" },
    { "light", "light" },
    { "breaks", "breaks" },
    { "isolines", "isolines" },
    { "strength", "strength" },
    { "decay", "decay" },
    { "power", "power" },
    { "sensors", "sensors" },
    { "ghost", "ghost" },
    { "at", "at" },
    { "ramp", "ramp_interval" },
    { "radius", "radius_m" },
    { "reach", "reach_m" },
    { "hide", "hidden" },
    { "only", "isolate" },
    { "asset", "selected" },
    { "tag", NULL },
};

bool view_address_add(struct view_address *address, const char *name, const char *value)
{
    if (address->count == VIEW_ADDRESS_ARGS)
        return false;
    address->args[address->count++] = mem_printf("%s=%s", name, value);
    return true;
}

static int hex_of(char c)
{
    static const char digits[] = "0123456789abcdefABCDEF";
    const char *at = c ? strchr(digits, c) : NULL;
    return !at ? -1 : at - digits < 16 ? (int)(at - digits) : (int)(at - digits) - 6;
}

/* Decodes percent-escapes and plus signs of a URL's field in place. */
static void decode(char *text)
{
    char *to = text;
    for (const char *from = text; *from; from++) {
        int high = *from == '%' ? hex_of(from[1]) : -1, low = high >= 0 ? hex_of(from[2]) : -1, byte = 16 * high + low;
        *to++ = low >= 0 && byte > 0 ? (char)byte : *from == '+' ? ' ' : *from;
        from += low >= 0 && byte > 0 ? 2 : 0;
    }
    *to = 0;
}

/* Reads comma-separated numbers into `out`. Returns how many were read; 0 if there are none, more than `most`, or any other text. */
static int read_numbers(const char *text, double *out, int most)
{
    for (int count = 0; count < most;) {
        char *end;
        out[count++] = strtod(text, &end);
        if (end == text)
            return 0;
        if (!*end)
            return count;
        if (*end != ',')
            return 0;
        text = end + 1;
    }
    return 0;
}

static bool add_camera(struct view_address *out, const char *value)
{
    double n[CAMERA_NUMBERS];
    int count = read_numbers(value, n, CAMERA_NUMBERS);
    bool parallel = count == CAMERA_NUMBERS;
    if (count < CAMERA_NUMBERS - 1)
        return false;
    char text[8 * 32], up[3 * 32], height[32];
    int length = snprintf(text, sizeof(text), "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g", n[0], n[1], n[2], n[3], n[4], n[5]);
    if (!parallel)
        snprintf(text + length, sizeof(text) - (size_t)length, ",%.9g", n[9]);
    snprintf(up, sizeof(up), "%.9g,%.9g,%.9g", n[6], n[7], n[8]);
    snprintf(height, sizeof(height), "%.9g", parallel ? n[10] : 0);
    return view_address_add(out, "camera", text) && view_address_add(out, "up", up) &&
           (!parallel || (view_address_add(out, "projection", "orthographic") && view_address_add(out, "height_m", height)));
}

static bool add_clip(struct view_address *out, const char *value)
{
    int commas = 0;
    for (const char *at = value; *at; at++)
        commas += *at == ',';
    return view_address_add(out, !strchr(value, ';') && commas == 5 ? "clip_box" : "clip", value);
}

/* Adds the parameters for the right half of a split view as the argument `split`. The value `same` (both halves have equal
   parameters) becomes an empty argument. */
static bool add_split(struct view_address *out, char *value)
{
    for (char *at = value, *colon; (colon = strchr(at, ':')); at = colon + strcspn(colon, ";"))
        *colon = '=';
    return view_address_add(out, "split", strcmp(value, "same") != 0 ? value : "");
}

static bool add_field(struct view_address *out, const char *name, char *value, struct message_error *error)
{
    bool good = true, known = true;
    size_t i = 0, count = sizeof(names) / sizeof(names[0]);
    while (i < count && strcmp(names[i].name, name) != 0)
        i++;
    if (!strcmp(name, "camera"))
        good = add_camera(out, value);
    else if (!strcmp(name, "clip"))
        good = add_clip(out, value);
    else if (!strcmp(name, "split"))
        good = add_split(out, value);
    else if (i < count)
        good = !names[i].of_query || view_address_add(out, names[i].of_query, value);
    else
        known = false;
    if (!good || !known)
        message_fail(error, "bad_field", "view address: %.40s: %s", name, known ? "the value is invalid" : "not available in a picture");
    return good && known;
}

/* Callback that receives one field NAME=VALUE of a view's address, percent-decoded; value "": the field has no value. Returns false to
   stop. */
typedef bool field_fn(void *arg, const char *name, char *value);

/* Calls `take` for each field NAME=VALUE of a view's address. Stops and returns false if `take` returns false. */
static bool each_field(const char *address, field_fn *take, void *arg)
{
    char *copy = mem_strdup(address), *rest = copy;
    bool good = true;
    for (char *part; good && (part = strsep(&rest, "&"));) {
        char *value = strchr(part, '=');
        if (!*part)
            continue;
        if (value)
            *value++ = 0;
        decode(part);
        if (value)
            decode(value);
        good = take(arg, part, value ? value : part + strlen(part));
    }
    mem_free(copy);
    return good;
}

struct address_reading {
    struct view_address *out;
    struct message_error *error;
};

static bool take(void *arg, const char *name, char *value)
{
    const struct address_reading *reading = arg;
    return add_field(reading->out, name, value, reading->error);
}

bool view_address_read(struct view_address *out, const char *address, struct message_error *error)
{
    *out = (struct view_address){ .count = 0 };
    return each_field(address, take, &(struct address_reading){ out, error });
}

bool view_address_is_named(const char *arg, const char *name)
{
    size_t length = strcspn(arg, "=");
    return strlen(name) == length && !strncmp(arg, name, length);
}

bool view_address_replaces(const char *given, const char *name)
{
    static const struct {
        const char *given, *replaces;
    } together[] = { { "camera", "up" },           { "camera", "projection" }, { "camera", "height_m" },
                     { "projection", "height_m" }, { "fit", "camera" },        { "fit", "up" },
                     { "fit", "projection" },      { "fit", "height_m" },      { "clip", "clip_box" },
                     { "clip_box", "clip" } };
    size_t length = strcspn(given, "=");
    bool replaced = length == strcspn(name, "=") && !strncmp(given, name, length);
    for (size_t i = 0; i < sizeof(together) / sizeof(together[0]); i++)
        replaced = replaced || (view_address_is_named(given, together[i].given) && view_address_is_named(name, together[i].replaces));
    return replaced;
}

bool view_address_set(struct view_address *address, const char *arg)
{
    size_t left = 0;
    for (size_t i = 0; i < address->count; i++)
        if (view_address_replaces(arg, address->args[i]))
            mem_free(address->args[i]);
        else
            address->args[left++] = address->args[i];
    address->count = left;
    if (!strcmp(arg, "at=now")) /* `at=now` means live, for which queries have no argument */
        return true;
    if (left == VIEW_ADDRESS_ARGS)
        return false;
    address->args[address->count++] = mem_strdup(arg);
    return true;
}

void view_address_finish(struct view_address *address)
{
    for (size_t i = 0; i < address->count; i++)
        mem_free(address->args[i]);
    address->count = 0;
}
