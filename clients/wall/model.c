/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The server's words, kept. */
#include "model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "model_plant.h"
#include "value/quality.h"

static const int64_t TIMED_NS = 60 * NS_PER_S; /* links get slower, and a server's clock may be set */

void model_init(struct model *model)
{
    int64_t now_ns = clock_mono_ns();
    *model = (struct model){ .rows = json_object(), .round_trip_ns = INT64_MAX, .offset_us = (clock_utc_ns() - now_ns) / 1000 };
}

static void forget_plant(struct model *model)
{
    model_plant_finish(&model->plant, &model->scene);
    snapshot_destroy(&model->snapshot);
    mem_free(model->read_ns);
    mem_free(model->list);
    json_decref(model->welcome);
    json_object_clear(model->rows);
    model->read_ns = NULL;
    model->list = NULL;
    model->list_count = 0;
    model->welcome = NULL;
}

void model_finish(struct model *model)
{
    forget_plant(model);
    json_decref(model->rows);
    json_decref(model->views);
    json_decref(model->orders);
    json_decref(model->notes);
}

int64_t model_now_us(const struct model *model)
{
    return clock_mono_ns() / 1000 + model->offset_us;
}

void model_pong(struct model *model, const json_t *message, int64_t now_ns)
{
    const json_t *oldest = json_object_get(message, "oldest_age_ms");
    int64_t sent_ns = (int64_t)json_number_value(json_object_get(message, "t")); /* the server says it as a real number */
    int64_t rtt_ns = now_ns - sent_ns, since_ns = now_ns - (int64_t)(fmin(json_number_value(oldest), 1e12) * 1e6);
    for (size_t i = 0; json_is_number(oldest) && i < model->plant.tag_count; i++) /* what did not change was read again */
        if (model->read_ns[i] && model->read_ns[i] < since_ns)
            model->read_ns[i] = since_ns;
    bool known = model->round_trip_ns != INT64_MAX && now_ns - model->timed_ns < TIMED_NS;
    if (rtt_ns < 0 || (known && rtt_ns > model->round_trip_ns + NS_PER_MS)) /* clocks drift apart: one that is about as short counts too */
        return;
    if (!known || rtt_ns <= model->round_trip_ns) {
        model->round_trip_ns = rtt_ns;
        model->timed_ns = now_ns;
    }
    model->offset_us = json_integer_value(json_object_get(message, "time_us")) - (now_ns - rtt_ns / 2) / 1000;
}

/* --- readings ----------------------------------------------------------------------------------------------------------------- */

static uint32_t quality_of(const char *name)
{
    return !name || !strcmp(name, "bad") ? QUALITY_BAD : !strcmp(name, "uncertain") ? QUALITY_UNCERTAIN : QUALITY_GOOD;
}

/* [index, value or null, quality, name, age_ms or null, ...]; a row of two is good, at most `age_ms` of the message old. */
static void take_reading(struct model *model, const json_t *row, double usual_age_ms, int64_t now_ns)
{
    json_int_t index = json_integer_value(json_array_get(row, 0));
    if (!json_is_integer(json_array_get(row, 0)) || index < 0 || (size_t)index >= model->snapshot->count)
        return;
    struct reading *reading = &model->snapshot->readings[index];
    const json_t *value = json_array_get(row, 1), *age = json_array_get(row, 4);
    bool brief = json_array_size(row) < 3;
    reading->quality = !json_is_number(value) ? QUALITY_BAD : brief ? QUALITY_GOOD : quality_of(json_string_value(json_array_get(row, 2)));
    reading->value = json_is_number(value) ? json_number_value(value) : 0;
    double age_ms = brief ? usual_age_ms : json_is_number(age) ? json_number_value(age) : -1;
    if (age_ms >= 0)
        model->read_ns[index] = now_ns - (int64_t)(fmin(age_ms, 1e12) * 1e6);
}

static void on_tags(struct model *model, const json_t *message, int64_t now_ns)
{
    const json_t *values = json_object_get(message, "values");
    double age_ms = json_number_value(json_object_get(message, "age_ms"));
    for (size_t i = 0; i < json_array_size(values); i++)
        take_reading(model, json_array_get(values, i), age_ms, now_ns);
}

int64_t model_oldest_ns(const struct model *model, const int *tags, size_t count, int group, int64_t now_ns)
{
    int64_t oldest_ns = -1;
    for (size_t i = 0; i < (tags ? count : model->plant.tag_count); i++) {
        size_t tag = tags ? (size_t)tags[i] : i;
        bool counts = tags ? tags[i] >= 0 : model->plant.tags[tag].group == group;
        if (counts && model->read_ns[tag] && !quality_is_bad(model->snapshot->readings[tag].quality) &&
            now_ns - model->read_ns[tag] > oldest_ns)
            oldest_ns = now_ns - model->read_ns[tag];
    }
    return oldest_ns;
}

/* --- alarms ------------------------------------------------------------------------------------------------------------------- */

static double number_or_nan(const json_t *value)
{
    return json_is_number(value) ? json_number_value(value) : NAN;
}

static bool read_alarm(const struct model *model, const json_t *row, struct model_alarm *alarm)
{
    const json_t *of = json_array_get(row, 0);
    const char *kind = json_string_value(json_array_get(row, 1)), *status = json_string_value(json_array_get(row, 2));
    *alarm = (struct model_alarm){ .tag = json_is_integer(of) ? (int)json_integer_value(of) : -1, .device = json_string_value(of) };
    alarm->kind = kind ? alarm_kind_find(kind) : ALARM_NONE;
    alarm->status = status ? alarm_status_find(status) : ALARM_STATUSES;
    alarm->priority = (int)json_integer_value(json_array_get(row, 3));
    alarm->raised_us = json_integer_value(json_array_get(row, 4));
    alarm->value = number_or_nan(json_array_get(row, 5));
    alarm->limit = number_or_nan(json_array_get(row, 6));
    alarm->waiting = alarm->status == ALARM_UNACKNOWLEDGED || alarm->status == ALARM_RETURNED;
    return alarm->kind != ALARM_NONE && alarm->status < ALARM_STATUSES && alarm->priority >= 1 && alarm->priority <= ALARM_PRIORITIES &&
           (alarm->device || (alarm->tag >= 0 && (size_t)alarm->tag < model->plant.tag_count));
}

static int by_list(const void *pa, const void *pb)
{
    const struct model_alarm *a = pa, *b = pb;
    bool gone_a = alarm_status_is_cleared(a->status), gone_b = alarm_status_is_cleared(b->status);
    if (a->waiting != b->waiting)
        return b->waiting - a->waiting;
    if (gone_a != gone_b)
        return gone_a - gone_b;
    if (a->priority != b->priority)
        return a->priority - b->priority;
    return (b->raised_us > a->raised_us) - (b->raised_us < a->raised_us);
}

static bool is_same(const struct model_alarm *a, const struct model_alarm *b)
{
    return a->tag == b->tag && (a->tag >= 0 || !strcmp(a->device, b->device));
}

static bool is_graver(const struct model_alarm *a, const struct model_alarm *b)
{
    struct alarm_grade i = { a->priority, a->kind, a->status }, k = { b->priority, b->kind, b->status };
    return alarm_graver(&i, &k) || (!alarm_graver(&k, &i) && a->raised_us > b->raised_us);
}

static void add_alarm(struct model *model, const struct model_alarm *alarm)
{
    for (size_t i = 0; i < model->list_count; i++) {
        struct model_alarm *known = &model->list[i];
        if (!is_same(known, alarm))
            continue;
        bool waiting = known->waiting || alarm->waiting;
        if (is_graver(alarm, known))
            *known = *alarm;
        known->waiting = waiting;
        return;
    }
    model->list[model->list_count++] = *alarm;
}

/* The overlay finds a ring's priority by the settings of its tag. */
static void mark_tags(struct model *model)
{
    for (size_t i = 0; i < model->snapshot->count; i++)
        model->snapshot->readings[i].alarm = ALARM_NONE;
    for (size_t i = 0; i < model->list_count; i++) {
        const struct model_alarm *alarm = &model->list[i];
        if (alarm->tag < 0)
            continue;
        bool inner = alarm->kind == ALARM_L || alarm->kind == ALARM_H;
        model->plant.tags[alarm->tag].alarm_settings.priority = inner && alarm->priority > 1 ? alarm->priority - 1 : alarm->priority;
        model->snapshot->readings[alarm->tag].alarm = (uint8_t)alarm->kind;
        model->snapshot->readings[alarm->tag].alarm_status = (uint8_t)alarm->status;
    }
}

static void sort_alarms(struct model *model)
{
    const char *key;
    json_t *row;
    mem_free(model->list);
    model->list = mem_array(json_object_size(model->rows) + 1, sizeof(*model->list));
    model->list_count = 0;
    json_object_foreach(model->rows, key, row)
    {
        struct model_alarm alarm;
        if (read_alarm(model, row, &alarm) && alarm_status_is_annunciated(alarm.status))
            add_alarm(model, &alarm);
    }
    qsort(model->list, model->list_count, sizeof(*model->list), by_list);
    mark_tags(model);
}

static void on_alarms(struct model *model, const json_t *message)
{
    const json_t *alarms = json_object_get(message, "alarms");
    if (json_is_true(json_object_get(message, "all")))
        json_object_clear(model->rows);
    for (size_t i = 0; i < json_array_size(alarms); i++) {
        json_t *row = json_array_get(alarms, i), *of = json_array_get(row, 0);
        const char *kind = json_string_value(json_array_get(row, 1)), *state = json_string_value(json_array_get(row, 2));
        char *key = json_is_string(of) ? mem_printf("%s/%s", json_string_value(of), kind ? kind : "")
                                       : mem_printf("%d/%s", (int)json_integer_value(of), kind ? kind : "");
        if (state && strcmp(state, "normal"))
            json_object_set(model->rows, key, row);
        else
            json_object_del(model->rows, key);
        mem_free(key);
    }
    sort_alarms(model);
}

const struct model_alarm *model_gravest(const struct model *model, int tag)
{
    for (size_t i = 0; i < model->list_count; i++)
        if (model->list[i].tag == tag && tag >= 0)
            return &model->list[i];
    return NULL;
}

const char *model_alarm_name(const struct model *model, const struct model_alarm *alarm)
{
    return alarm->tag >= 0 ? model->plant.tags[alarm->tag].name : alarm->device;
}

/* --- the rest ------------------------------------------------------------------------------------------------------------------- */

static bool on_welcome(struct model *model, const json_t *message)
{
    forget_plant(model);
    json_decref(model->views);
    json_decref(model->orders);
    json_decref(model->notes);
    model->views = model->orders = model->notes = NULL;
    model->live = true; /* until status says otherwise */
    model->clock_set = true;
    model->welcome = json_deep_copy(message);
    if (!model_plant_init(&model->plant, &model->scene, model->welcome)) {
        forget_plant(model);
        return false;
    }
    model->snapshot = snapshot_create(model->plant.tag_count);
    model->read_ns = mem_array(model->plant.tag_count + 1, sizeof(*model->read_ns));
    return true;
}

static void on_status(struct model *model, const json_t *message)
{
    const json_t *links = json_object_get(message, "links");
    model->live = !json_is_false(json_object_get(message, "live"));
    model->clock_set = !json_is_false(json_object_get(message, "clock_set"));
    model->simulated = false;
    for (size_t i = 0; i < json_array_size(links); i++)
        model->simulated |= json_is_true(json_object_get(json_array_get(links, i), "simulated"));
}

static void keep_list(json_t **to, const json_t *message)
{
    json_decref(*to);
    *to = json_incref(json_object_get(message, "list"));
}

bool model_hear(struct model *model, const json_t *message, int64_t now_ns)
{
    const char *type = json_string_value(json_object_get(message, "type"));
    if (!type)
        return false;
    if (!strcmp(type, "welcome"))
        return on_welcome(model, message);
    if (!model->welcome)
        return true;
    if (!strcmp(type, "tags"))
        on_tags(model, message, now_ns);
    else if (!strcmp(type, "alarms"))
        on_alarms(model, message);
    else if (!strcmp(type, "status"))
        on_status(model, message);
    else if (!strcmp(type, "views"))
        keep_list(&model->views, message);
    else if (!strcmp(type, "walls"))
        keep_list(&model->orders, message);
    else if (!strcmp(type, "notes"))
        keep_list(&model->notes, message);
    return true;
}

const json_t *model_view(const struct model *model, const char *id)
{
    for (size_t i = 0; i < json_array_size(model->views); i++) {
        const json_t *view = json_array_get(model->views, i);
        const char *known = json_string_value(json_object_get(view, "id"));
        if (known && !strcmp(known, id))
            return view;
    }
    return NULL;
}
