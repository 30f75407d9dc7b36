/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts the outbox of alarm messages to JSON and back. It contains the alarms that were raised, which recipients were
   notified of each alarm, and queued messages. Names identify recipients, rules and alarms. */
#include "notify/outbox_impl.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"

enum { VERSION = 1 };

/* --- save ------------------------------------------------------------------------------------------------------------------- */

static json_t *number_or_null(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

static json_t *save_item(const struct outbox *outbox, const struct outbox_item *item)
{
    return json_pack("{s:s,s:s,s:i,s:i,s:s,s:o,s:o,s:s,s:I,s:I}", "name", item->name, "kind", alarm_kind_name(item->kind), "priority",
                     item->priority, "step", item->step, "status", alarm_status_name(item->status), "value", number_or_null(item->value),
                     "limit", number_or_null(item->limit), "unit", plant_tag_unit(outbox->plant, item->tag), "raised",
                     (json_int_t)item->raised_us, "ended", (json_int_t)item->ended_us);
}

static json_t *save_box(const struct outbox *outbox, const struct recipient_box *box)
{
    json_t *waiting = json_array(), *batch = json_array();
    for (size_t i = 0; i < box->waiting.count; i++)
        json_array_append_new(waiting, save_item(outbox, &box->waiting.at[i].said));
    for (size_t i = 0; i < box->batch_count; i++)
        json_array_append_new(batch, save_item(outbox, &box->batch[i]));
    return json_pack("{s:o,s:o,s:s,s:I,s:I,s:I,s:i,s:I}", "waiting", waiting, "message", batch, "id", box->id, "made",
                     (json_int_t)box->batch_us, "since", (json_int_t)box->since_us, "sent", (json_int_t)box->sent_us, "last_priority",
                     box->last_priority, "left_out", (json_int_t)box->left_out);
}

static json_t *save_episode(const struct outbox *outbox, const struct episode *episode)
{
    const struct plant_notify *notify = outbox->plant->notify;
    json_t *told = json_array(), *steps = json_object();
    for (size_t i = 0; i < notify->recipient_count; i++)
        if (episode->told >> i & 1)
            json_array_append_new(told, json_string(notify->recipients[i].id));
    for (size_t i = 0; i < notify->rule_count; i++)
        if (episode->rules >> i & 1)
            json_object_set_new(steps, notify->rules[i].id, json_integer(episode->steps[i]));
    return json_pack("{s:s,s:s,s:i,s:s,s:o,s:o,s:s,s:I,s:I,s:I,s:I,s:I,s:o,s:o}", "name", episode->name, "kind",
                     alarm_kind_name(episode->kind), "priority", episode->priority, "status", alarm_status_name(episode->status), "value",
                     number_or_null(episode->value), "limit", number_or_null(episode->limit), "unit",
                     plant_tag_unit(outbox->plant, episode->tag), "raised", (json_int_t)episode->raised_us, "began",
                     (json_int_t)episode->began_us, "ended", (json_int_t)episode->ended_us, "cleared", (json_int_t)episode->cleared_us,
                     "told_at", (json_int_t)episode->told_us, "told", told, "steps", steps);
}

json_t *outbox_save(const struct outbox *outbox)
{
    const struct plant_notify *notify = outbox->plant->notify;
    json_t *episodes = json_array(), *boxes = json_object();
    for (size_t i = 0; i < outbox->count; i++)
        json_array_append_new(episodes, save_episode(outbox, &outbox->episodes[i]));
    for (size_t i = 0; i < notify->recipient_count; i++)
        if (notify->recipients[i].kind != NOTIFY_ALERTMANAGER)
            json_object_set_new(boxes, notify->recipients[i].id, save_box(outbox, &outbox->boxes[i]));
    return json_pack("{s:i,s:o,s:o}", "version", VERSION, "alarms", episodes, "recipients", boxes);
}

/* --- restore ---------------------------------------------------------------------------------------------------------------- */

static int64_t integer_of(const json_t *object, const char *key)
{
    return json_integer_value(json_object_get(object, key));
}

/* Returns an alarm's saved value or limit, converted to the tag's present unit; NAN: there is none, or its unit is unknown or
   not convertible. */
static double value_of(const struct outbox *outbox, const json_t *object, const char *key, int tag)
{
    const json_t *value = json_object_get(object, key);
    const char *unit = json_string_value(json_object_get(object, "unit"));
    return json_is_number(value) && unit ? alarm_value_in_unit(json_number_value(value), unit, plant_tag_unit(outbox->plant, tag)) : NAN;
}

/* Reads the name and kind of an alarm; *tag receives its tag's index, or -1 for a device's alarm. Returns true if the plant still has
   that alarm. */
static bool read_alarm(const struct outbox *outbox, const json_t *object, const char **name, int *tag, enum alarm_kind *kind)
{
    const char *kind_name = json_string_value(json_object_get(object, "kind"));
    *name = json_string_value(json_object_get(object, "name"));
    *kind = kind_name ? alarm_kind_find(kind_name) : ALARM_NONE;
    *tag = *name && *kind != ALARM_LINK ? plant_find_tag(outbox->plant, *name) : -1;
    return *name && *kind != ALARM_NONE && (*tag >= 0 || *kind == ALARM_LINK);
}

static int read_priority(const json_t *object, const char *key)
{
    int64_t priority = integer_of(object, key);
    return priority < 1 || priority > ALARM_PRIORITIES ? ALARM_PRIORITIES : (int)priority;
}

static enum alarm_status read_status(const json_t *object)
{
    const char *name = json_string_value(json_object_get(object, "status"));
    enum alarm_status status = name ? alarm_status_find(name) : ALARM_NORMAL;
    return status == ALARM_STATUSES ? ALARM_NORMAL : status;
}

static void restore_episode(struct outbox *outbox, const json_t *object)
{
    const struct plant_notify *notify = outbox->plant->notify;
    const char *name;
    int tag;
    enum alarm_kind kind;
    if (!read_alarm(outbox, object, &name, &tag, &kind) || outbox_find(outbox, name, tag, kind) >= 0)
        return;
    struct episode *episode = outbox_add_episode(outbox, name, tag, kind);
    episode->priority = read_priority(object, "priority");
    episode->status = read_status(object);
    episode->value = value_of(outbox, object, "value", tag);
    episode->limit = value_of(outbox, object, "limit", tag);
    episode->raised_us = integer_of(object, "raised");
    episode->began_us = integer_of(object, "began");
    episode->ended_us = integer_of(object, "ended");
    episode->cleared_us = integer_of(object, "cleared");
    episode->told_us = integer_of(object, "told_at");
    episode->aside = episode->status >= ALARM_SHELVED;
    size_t index;
    json_t *told;
    json_array_foreach(json_object_get(object, "told"), index, told)
        for (size_t i = 0; i < notify->recipient_count; i++)
            if (json_is_string(told) && !strcmp(json_string_value(told), notify->recipients[i].id))
                episode->told |= UINT32_C(1) << i;
    for (size_t i = 0; i < notify->rule_count; i++) {
        const json_t *steps = json_object_get(json_object_get(object, "steps"), notify->rules[i].id);
        int64_t taken = json_integer_value(steps);
        episode->rules |= (uint32_t)json_is_integer(steps) << i;
        episode->steps[i] = (uint8_t)(taken < 0 || taken > NOTIFY_STEPS ? NOTIFY_STEPS : taken);
    }
}

static bool restore_item(const struct outbox *outbox, const json_t *object, struct outbox_item *item)
{
    const char *name;
    if (!read_alarm(outbox, object, &name, &item->tag, &item->kind))
        return false;
    int64_t step = integer_of(object, "step");
    item->name = mem_strdup(name);
    item->priority = read_priority(object, "priority");
    item->step = step < 0 || step >= NOTIFY_STEPS ? 0 : (int)step;
    item->status = read_status(object);
    item->value = value_of(outbox, object, "value", item->tag);
    item->limit = value_of(outbox, object, "limit", item->tag);
    item->raised_us = integer_of(object, "raised");
    item->ended_us = integer_of(object, "ended");
    return true;
}

static void restore_box(struct outbox *outbox, struct recipient_box *box, const json_t *object)
{
    size_t index;
    json_t *item;
    const json_t *waiting = json_object_get(object, "waiting"), *batch = json_object_get(object, "message");
    const char *id = json_string_value(json_object_get(object, "id"));
    json_array_foreach(waiting, index, item) {
        mem_grow(&box->waiting.at, &box->waiting.capacity, box->waiting.count + 1, sizeof(*box->waiting.at));
        struct queued_item *to = &box->waiting.at[box->waiting.count];
        if (outbox->items < OUTBOX_ITEMS && restore_item(outbox, item, &to->said)) {
            to->episode = outbox_find(outbox, to->said.name, to->said.tag, to->said.kind);
            box->waiting.count++;
            outbox->items++;
        }
    }
    box->batch = json_array_size(batch) > 0 ? mem_array(json_array_size(batch), sizeof(*box->batch)) : NULL;
    json_array_foreach(batch, index, item)
        if (outbox->items < OUTBOX_ITEMS && restore_item(outbox, item, &box->batch[box->batch_count])) {
            box->batch_count++;
            outbox->items++;
        }
    if (id)
        strncpy(box->id, id, sizeof(box->id) - 1);
    box->batch_us = integer_of(object, "made");
    box->since_us = integer_of(object, "since");
    box->sent_us = integer_of(object, "sent");
    box->left_out = integer_of(object, "left_out");
    box->last_priority = read_priority(object, "last_priority");
    box->attempts = box->batch_count > 0;
}

bool outbox_restore(struct outbox *outbox, const json_t *saved)
{
    const struct plant_notify *notify = outbox->plant->notify;
    size_t index;
    json_t *object;
    if (integer_of(saved, "version") != VERSION)
        return false;
    json_array_foreach(json_object_get(saved, "alarms"), index, object)
        restore_episode(outbox, object);
    for (size_t i = 0; i < notify->recipient_count; i++) {
        const json_t *box = json_object_get(json_object_get(saved, "recipients"), notify->recipients[i].id);
        if (box && notify->recipients[i].kind != NOTIFY_ALERTMANAGER)
            restore_box(outbox, &outbox->boxes[i], box);
    }
    return true;
}
