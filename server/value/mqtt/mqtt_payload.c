/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses MQTT payloads: numbers in text, and values, times and qualities in JSON. */
#include "value/mqtt/mqtt_payload.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "base/text/timestamp.h"
#include "plant/parse/number.h"
#include "value/mqtt/json_select.h"
#include "value/quality.h"

enum { NUMBER_BYTES = 64 };

/* --- text ------------------------------------------------------------------------------------------------------------------- */

static bool boolean_of(const char *text, bool *out)
{
    *out = !strcasecmp(text, "true");
    return *out || !strcasecmp(text, "false");
}

static bool number_of(const char *text, double *out)
{
    bool boolean;
    if (!boolean_of(text, &boolean))
        return number_parse(text, out) == NUMBER_GOOD;
    *out = boolean;
    return true;
}

bool mqtt_number_read(const void *bytes, size_t count, double *out)
{
    const char *at = bytes;
    char text[NUMBER_BYTES];
    while (count > 0 && memchr(" \t\r\n", *at, 4)) {
        at++;
        count--;
    }
    while (count > 0 && memchr(" \t\r\n", at[count - 1], 4))
        count--;
    if (count == 0 || count >= sizeof(text) || memchr(at, 0, count))
        return false;
    memcpy(text, at, count);
    text[count] = 0;
    return number_of(text, out);
}

/* --- JSON ------------------------------------------------------------------------------------------------------------------- */

json_t *mqtt_json_parse(const void *bytes, size_t count, char why[200])
{
    json_error_t error;
    json_t *root = json_loadb(bytes, count, JSON_DECODE_ANY | JSON_DECODE_INT_AS_REAL | JSON_REJECT_DUPLICATES, &error);
    if (!root)
        snprintf(why, 200, "not valid JSON: %.150s", error.text);
    return root;
}

static bool read_number(const json_t *json, double *out)
{
    if (json_is_boolean(json))
        *out = json_is_true(json);
    else if (json_is_number(json))
        *out = json_number_value(json);
    else
        return json_is_string(json) && number_of(json_string_value(json), out);
    return isfinite(*out);
}

/* Converts a time since 1970 to nanoseconds. The number's magnitude shows its unit (s, ms, us or ns); this is unambiguous for the years
   1973 to 5138. Returns false for other numbers. */
static bool read_epoch(double number, int64_t *utc_ns)
{
    static const double SECONDS_LOW = 1e8, SECONDS_HIGH = 1e11;
    double scale_ns = 1e9;
    for (double high = SECONDS_HIGH; number >= high && scale_ns > 1; high *= 1000)
        scale_ns /= 1000;
    bool good = number >= SECONDS_LOW && number * scale_ns < 9e18;
    if (good)
        *utc_ns = (int64_t)(number * scale_ns);
    return good;
}

static bool read_time(const json_t *json, int64_t *utc_ns)
{
    int64_t t_us;
    double number;
    if (json_is_string(json) && strchr(json_string_value(json), 'T') && timestamp_parse(json_string_value(json), 0, &t_us)) {
        *utc_ns = t_us < INT64_MAX / 1000 && t_us > 0 ? t_us * 1000 : 0;
        return *utc_ns != 0;
    }
    return !json_is_boolean(json) && read_number(json, &number) && read_epoch(number, utc_ns);
}

/* Returns the quality in a member of a JSON message: an OPC UA status code, a boolean, or a word that begins with a severity such
   as "good". Publishers may write the code and the boolean as text. Uncertain for anything else. */
static uint32_t read_quality(const json_t *json)
{
    static const struct {
        const char *word;
        uint32_t quality;
    } words[] = { { "good", QUALITY_GOOD }, { "ok", QUALITY_GOOD }, { "bad", QUALITY_BAD } };
    double number;
    bool is_good = json_is_true(json);
    for (size_t i = 0; json_is_string(json) && i < sizeof(words) / sizeof(*words); i++)
        if (!strncasecmp(json_string_value(json), words[i].word, strlen(words[i].word)))
            return words[i].quality;
    if (json_is_boolean(json) || (json_is_string(json) && boolean_of(json_string_value(json), &is_good)))
        return is_good ? QUALITY_GOOD : QUALITY_BAD;
    bool is_code = read_number(json, &number) && (number == 0 || (number >= 65536 && number <= UINT32_MAX));
    return is_code ? (uint32_t)number : QUALITY_UNCERTAIN;
}

/* --- a tag's value ---------------------------------------------------------------------------------------------------------- */

/* Returns the value selected by the reader's path; without a path, the whole payload or its member `value`. */
static struct json_selected value_of(const json_t *root, const struct mqtt_reader *reader)
{
    if (*reader->path)
        return json_select(root, reader->path, reader->tag);
    return json_select(root, json_is_object(root) ? "value" : "$", reader->tag);
}

/* Returns the JSON value (a tag's time or quality) that a path selects, or NULL if it selects none or several. A path that begins with
   `@` starts in the object that contains the tag's value. */
static const json_t *select_stated(const json_t *root, const struct json_selected *value, const char *path, const char *tag)
{
    struct json_selected found = json_select(*path == '@' ? value->holder : root, path, tag);
    return found.count == 1 ? found.value : NULL;
}

static enum mqtt_found refuse(struct stamped_value *out, uint32_t quality)
{
    *out = (struct stamped_value){ .quality = quality };
    return MQTT_WRONG;
}

static enum mqtt_found refuse_selection(const struct json_selected *found, const struct mqtt_reader *reader, struct stamped_value *out,
                                        char why[200])
{
    const char *tag = reader->tag, *path = reader->path;
    if (found->count > 1) {
        snprintf(why, 200, "tag %.40s: the path %.60s selects %zu values in the message; expected one", tag, path, found->count);
        return refuse(out, QUALITY_BAD_TOO_MANY_MATCHES);
    }
    if (!found->foreign)
        return MQTT_ABSENT;
    char number[32];
    snprintf(number, sizeof(number), "%.15g", json_number_value(found->foreign));
    const char *name = json_is_string(found->foreign) ? json_string_value(found->foreign) : number;
    snprintf(why, 200,
             "%.35s: the list item at %.35s is named %.35s, not the tag's name; select it by name, such as [?@.id=='...']",
             tag, path, name);
    return refuse(out, QUALITY_BAD_NO_MATCH);
}

enum mqtt_found mqtt_json_read(const json_t *root, const struct mqtt_reader *reader, struct stamped_value *out, char why[200])
{
    const struct plant_mqtt *mqtt = reader->mqtt;
    struct json_selected found = value_of(root, reader);
    *out = (struct stamped_value){ .quality = QUALITY_GOOD };
    if (found.count != 1)
        return refuse_selection(&found, reader, out, why);
    const json_t *time = mqtt->time ? select_stated(root, &found, mqtt->time, reader->tag) : NULL;
    const json_t *quality = mqtt->quality ? select_stated(root, &found, mqtt->quality, reader->tag) : NULL;
    if (mqtt->time && (!time || !read_time(time, &out->utc_ns))) {
        snprintf(why, 200, "%.60s is not a time", mqtt->time);
        return refuse(out, QUALITY_BAD_CONFIGURATION);
    }
    if (mqtt->quality)
        out->quality = quality ? read_quality(quality) : QUALITY_UNCERTAIN;
    if (json_is_null(found.value) && !quality_is_bad(out->quality))
        out->quality = QUALITY_BAD_SENSOR_FAILURE;
    if (quality_is_bad(out->quality) || read_number(found.value, &out->value))
        return MQTT_FOUND;
    snprintf(why, 200, "%.60s is not a number", *reader->path ? reader->path : "the value");
    return refuse(out, QUALITY_BAD_CONFIGURATION);
}
