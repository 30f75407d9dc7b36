/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Judges from hourly means of recorded readings whether sensors drift (slowly depart from the true value). The expected error
   of a mean combines the group's sensor noise and the recording tolerance. */
#include "service/drift_report.h"

#include <jansson.h>
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/json_text.h"
#include "history/month.h"
#include "message/json_values.h"
#include "plant/influence.h"

static const int64_t HOUR_US = 3600 * US_PER_S;

static int64_t begin_of(int64_t to_us)
{
    return to_us - to_us % HOUR_US - DRIFT_HOURS * HOUR_US;
}

/* Returns the expected error of a recorded value: the sensor noise combined with the recording filter's tolerance. */
static double noise_of(const struct plant *plant, const struct history_tag *tag, int group)
{
    const struct plant_group *of = &plant->groups[group];
    double noise = of->gp.noise > 0 ? of->gp.noise : PLANT_GP_NOISE * (of->max - of->min);
    return hypot(noise, tag->within);
}

static bool read_values(struct drift_report *report, struct history_reader *reader, const struct plant *plant, int64_t to_us)
{
    double hours[DRIFT_HOURS];
    bool good = true;
    for (size_t i = 0; i < report->count && good; i++) {
        const char *tag = plant->tags[neighbours_tag(report->neighbours, i)].name;
        good = history_hourly(reader, tag, to_us, DRIFT_HOURS, hours) == 0;
        for (size_t h = 0; h < DRIFT_HOURS && good; h++)
            report->values[h * report->count + i] = hours[h];
    }
    return good;
}

bool drift_report_read(struct drift_report *report, struct history_reader *reader, const struct scene *scene, int asset, int group,
                       int64_t to_us)
{
    const struct plant *plant = scene->plant;
    *report = (struct drift_report){ .neighbours = neighbours_create(scene, asset, group), .from_us = begin_of(to_us) };
    if (!report->neighbours)
        return true;
    report->count = neighbours_count(report->neighbours);
    report->drifts = mem_array(report->count, sizeof(*report->drifts));
    report->values = mem_array(report->count * DRIFT_HOURS, sizeof(*report->values));
    report->predicted = mem_array(report->count * DRIFT_HOURS, sizeof(*report->predicted));
    bool good = read_values(report, reader, plant, to_us);
    if (good) {
        double *noise = mem_array(report->count, sizeof(*noise));
        struct history_tag *tags = history_tags(plant);
        for (size_t i = 0; i < report->count; i++)
            noise[i] = noise_of(plant, &tags[neighbours_tag(report->neighbours, i)], group);
        drift_find(report->neighbours, report->values, DRIFT_HOURS, noise, report->drifts, report->predicted);
        mem_free(tags);
        mem_free(noise);
    } else {
        drift_report_finish(report);
    }
    return good;
}

void drift_report_finish(struct drift_report *report)
{
    neighbours_destroy(&report->neighbours);
    mem_free(report->drifts);
    mem_free(report->values);
    mem_free(report->predicted);
    *report = (struct drift_report){ 0 };
}

const char *drift_verdict_name(enum drift_verdict verdict)
{
    return verdict == DRIFT_FOUND ? "found" : verdict == DRIFT_NONE ? "none" : "unknown";
}

enum { DIGITS = 6, EXACT = 0 };

static json_t *hours_of(const struct drift_report *report, size_t sensor)
{
    json_t *hours = json_array();
    for (size_t h = 0; h < DRIFT_HOURS; h++)
        json_array_append_new(hours, json_pack("[I,o,o]", (json_int_t)(report->from_us + (int64_t)h * HOUR_US),
                                               number(report->values[h * report->count + sensor]),
                                               number(report->predicted[h * report->count + sensor])));
    return hours;
}

void drift_text_begin(struct text *out, const struct plant *plant, int group, int64_t to_us)
{
    json_t *head = json_pack("{s:I,s:I,s:o,s:o}", "from_us", (json_int_t)begin_of(to_us), "to_us",
                             (json_int_t)(begin_of(to_us) + DRIFT_HOURS * HOUR_US), "group", string(plant->groups[group].id), "unit",
                             string(plant->groups[group].unit));
    char *text = json_text(head, EXACT);
    text_add_bytes(out, text, strlen(text) - 1); /* omits the closing brace of the JSON object, because more members follow */
    text_add(out, ",\"sensors\":[");
    mem_free(text);
}

void drift_text_add(struct text *out, const struct plant *plant, const struct drift_report *report, int tag, bool *any)
{
    for (size_t i = 0; i < report->count; i++) {
        const struct drift *drift = &report->drifts[i];
        int of = neighbours_tag(report->neighbours, i);
        if (tag >= 0 && of != tag)
            continue;
        json_t *sensor = json_pack("{s:o,s:s,s:s,s:o,s:o,s:o,s:i}", "tag", string(plant->tags[of].name), "verdict",
                                   drift_verdict_name(drift->verdict), "cause", drift_unknown_cause(drift, report->count), "change",
                                   number(drift->change), "error", number(drift->error), "scatter", number(drift->scatter), "hours",
                                   drift->hours);
        if (tag >= 0)
            json_object_set_new(sensor, "by_hour", hours_of(report, i));
        char *text = json_text(sensor, DIGITS);
        text_add(out, "%s%s", *any ? "," : "", text);
        *any = true;
        mem_free(text);
    }
}

void drift_text_end(struct text *out)
{
    text_add(out, "]}\n");
}
