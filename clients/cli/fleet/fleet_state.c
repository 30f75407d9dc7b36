/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses the /metrics of plants' servers into their states, and prints these states as JSON and as metrics. */
#include "fleet_state.h"

#include <jansson.h>
#include <stdlib.h>
#include <string.h>

#include "base/text/json_text.h"

/* --- one plant -------------------------------------------------------------------------------------------------------------- */

/* Returns the rest of `line` after `name`, or NULL if the line does not begin with `name`. */
static const char *after(const char *line, const char *name)
{
    size_t length = strlen(name);
    return strncmp(line, name, length) == 0 ? line + length : NULL;
}

static int64_t value_of(const char *line)
{
    size_t length = strcspn(line, "\n");
    const char *blank = memrchr(line, ' ', length);
    double value = blank ? strtod(blank, NULL) : 0;
    return value > -9e15 && value < 9e15 ? (int64_t)value : 0;
}

static void read_version(const char *labels, char *version)
{
    const char *at = strstr(labels, "version=\""), *end = strchr(labels, '\n');
    if (!at || (end && at > end))
        return;
    size_t length = strcspn(at + 9, "\"\n");
    length = length < FLEET_TEXT_BYTES ? length : FLEET_TEXT_BYTES - 1;
    memcpy(version, at + 9, length);
    version[length] = 0;
}

static void read_line(const char *line, struct fleet_state *state)
{
    const struct {
        const char *name;
        int64_t *to;
    } plain[] = {
        { "plantcast_alarms{state=\"unacknowledged\"} ", &state->unacknowledged },
        { "plantcast_sessions ", &state->sessions },
        { "plantcast_certificate_expiry_timestamp_seconds ", &state->certificate_s },
        { "plantcast_backup_timestamp_seconds ", &state->backup_s },
        { "plantcast_history_free_bytes ", &state->free_bytes },
    };
    const char *rest;
    for (size_t i = 0; i < sizeof(plain) / sizeof(*plain); i++)
        if (after(line, plain[i].name))
            *plain[i].to = value_of(line);
    if ((rest = after(line, "plantcast_alarms_shown{priority=\"")) && *rest >= '1' && *rest < '1' + FLEET_PRIORITIES)
        state->alarms[*rest - '1'] = value_of(line);
    if (after(line, "plantcast_source_up{")) {
        state->links++;
        state->links_down += value_of(line) == 0;
    }
    if (after(line, "plantcast_history_good ") || after(line, "plantcast_alarm_journal_good "))
        state->recorded &= value_of(line) != 0;
    if (after(line, "plantcast_reload_good "))
        state->reloaded = value_of(line) != 0;
    if ((rest = after(line, "plantcast_build_info{")))
        read_version(rest, state->version);
}

bool fleet_state_read(const char *metrics, struct fleet_state *out)
{
    bool any = false;
    *out = (struct fleet_state){ .recorded = true, .reloaded = true };
    for (const char *line = metrics; line && *line; line = strchr(line, '\n'), line += line != NULL) {
        if (!after(line, "plantcast_"))
            continue;
        any = true;
        read_line(line, out);
    }
    return any;
}

/* --- all plants ------------------------------------------------------------------------------------------------------------- */

static json_t *plant_json(const struct fleet_plant *plant, const struct fleet_plant_state *known)
{
    const struct fleet_state *state = &known->state;
    json_t *alarms = json_array();
    for (int i = 0; i < FLEET_PRIORITIES; i++)
        json_array_append_new(alarms, json_integer(state->alarms[i]));
    json_t *one = json_pack("{s:s,s:s,s:s,s:b,s:I,s:I,s:s,s:I}", "id", plant->id, "name", plant->name, "url", plant->url, "answers",
                            known->answers, "answered_us", (json_int_t)known->answered_us, "silent_us", (json_int_t)known->silent_us, "why",
                            known->why, "picture", (json_int_t)known->picture);
    json_t *more = json_pack("{s:o,s:I,s:I,s:I,s:I}", "alarms", alarms, "unacknowledged", (json_int_t)state->unacknowledged, "links",
                             (json_int_t)state->links, "links_down", (json_int_t)state->links_down, "sessions",
                             (json_int_t)state->sessions);
    json_t *rest = json_pack("{s:s,s:I,s:I,s:I,s:b,s:b}", "version", state->version, "certificate_s", (json_int_t)state->certificate_s,
                             "backup_s", (json_int_t)state->backup_s, "free_bytes", (json_int_t)state->free_bytes, "recorded",
                             state->recorded, "reloaded", state->reloaded);
    json_object_update(more, rest);
    json_decref(rest);
    if (known->answered_us)
        json_object_update(one, more);
    json_decref(more);
    return one;
}

char *fleet_json(const struct fleet_file *file, const struct fleet_plant_state *states, int64_t now_us)
{
    json_t *plants = json_array();
    for (size_t i = 0; i < file->count; i++)
        json_array_append_new(plants, plant_json(&file->plants[i], &states[i]));
    return json_text(json_pack("{s:s,s:I,s:o}", "name", file->name, "time_us", (json_int_t)now_us, "plants", plants), 0);
}

static void add_metric(const struct fleet_file *file, const struct fleet_plant_state *states, struct text *out, const char *name,
                       const char *type, const char *help, int64_t (*value)(const struct fleet_plant_state *of))
{
    text_add(out, "# HELP %s %s\n# TYPE %s %s\n", name, help, name, type);
    for (size_t i = 0; i < file->count; i++)
        if (value(&states[i]) != INT64_MIN)
            text_add(out, "%s{plant=\"%s\"} %lld\n", name, file->plants[i].id, (long long)value(&states[i]));
}

static int64_t up_of(const struct fleet_plant_state *of)
{
    return of->answers;
}

static int64_t asked_of(const struct fleet_plant_state *of)
{
    return of->asked;
}

/* Defines a function that returns a member of a server's state, or INT64_MIN (no sample) while the server does not answer: old
   values must not be published as current ones. */
#define WHILE_IT_ANSWERS(member) \
    static int64_t member##_of(const struct fleet_plant_state *of) \
    { \
        return of->answers ? of->state.member : INT64_MIN; \
    }
WHILE_IT_ANSWERS(unacknowledged)
WHILE_IT_ANSWERS(links_down)
WHILE_IT_ANSWERS(certificate_s)
WHILE_IT_ANSWERS(backup_s)
WHILE_IT_ANSWERS(free_bytes)
WHILE_IT_ANSWERS(recorded)

void fleet_metrics(const struct fleet_file *file, const struct fleet_plant_state *states, struct text *out)
{
    add_metric(file, states, out, "plantcast_fleet_up", "gauge", "1 while the plant's daemon answers, else 0.", up_of);
    add_metric(file, states, out, "plantcast_fleet_polls_total", "counter", "Total number of requests sent to the plant's daemon.",
               asked_of);
    text_add(out,
             "# HELP plantcast_fleet_alarms Alarms in the alarm list of the plant, by priority.\n# TYPE plantcast_fleet_alarms gauge\n");
    for (size_t i = 0; i < file->count; i++)
        for (int k = 0; k < FLEET_PRIORITIES && states[i].answers; k++)
            text_add(out, "plantcast_fleet_alarms{plant=\"%s\",priority=\"%d\"} %lld\n", file->plants[i].id, k + 1,
                     (long long)states[i].state.alarms[k]);
    add_metric(file, states, out, "plantcast_fleet_unacknowledged", "gauge", "Unacknowledged alarms.", unacknowledged_of);
    add_metric(file, states, out, "plantcast_fleet_links_down", "gauge",
               "Number of the plant's sources (field devices) without a connection.", links_down_of);
    add_metric(file, states, out, "plantcast_fleet_certificate_expiry_timestamp_seconds", "gauge",
               "Expiry time of the plant's TLS certificate, in seconds since 1970; 0: no certificate.", certificate_s_of);
    add_metric(file, states, out, "plantcast_fleet_backup_timestamp_seconds", "gauge",
               "Time of the plant's last backup, in seconds since 1970; 0: unknown.", backup_s_of);
    add_metric(file, states, out, "plantcast_fleet_free_bytes", "gauge", "Free disk space in bytes for the plant's history.",
               free_bytes_of);
    add_metric(file, states, out, "plantcast_fleet_recorded", "gauge", "1 while the plant's daemon can write history and alarms, else 0.",
               recorded_of);
}
