/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decides which recipients are notified of which alarms and when, and queues the notifications. */
#include "notify/outbox_impl.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "notify/shift.h"

static const int64_t S = 1000000, RETRY_MAX_US = 60 * INT64_C(1000000), FORGET_US = 900 * INT64_C(1000000);

/* --- episodes --------------------------------------------------------------------------------------------------------------- */

struct outbox *outbox_create(const struct plant *plant)
{
    struct outbox *outbox = mem_new(sizeof(*outbox));
    outbox->plant = plant;
    outbox->by_alarm = mem_array(plant->tag_count * ALARM_KINDS + 1, sizeof(*outbox->by_alarm));
    outbox->boxes = mem_array(plant->notify->recipient_count + 1, sizeof(*outbox->boxes));
    return outbox;
}

static void free_batch(struct recipient_box *box)
{
    for (size_t i = 0; i < box->batch_count; i++)
        mem_free(box->batch[i].name);
    mem_free(box->batch);
    box->batch = NULL;
    box->batch_count = 0;
}

void outbox_destroy(struct outbox **pointer)
{
    struct outbox *outbox = *pointer;
    if (!outbox)
        return;
    for (size_t i = 0; i < outbox->plant->notify->recipient_count; i++) {
        for (size_t k = 0; k < outbox->boxes[i].waiting.count; k++)
            mem_free(outbox->boxes[i].waiting.at[k].said.name);
        mem_free(outbox->boxes[i].waiting.at);
        free_batch(&outbox->boxes[i]);
    }
    for (size_t i = 0; i < outbox->count; i++)
        mem_free(outbox->episodes[i].name);
    mem_free(outbox->episodes);
    mem_free(outbox->by_alarm);
    mem_free(outbox->boxes);
    mem_free(outbox);
    *pointer = NULL;
}

int outbox_find(const struct outbox *outbox, const char *name, int tag, enum alarm_kind kind)
{
    if (tag >= 0)
        return outbox->by_alarm[(size_t)tag * ALARM_KINDS + (size_t)kind] - 1;
    for (size_t i = 0; i < outbox->count; i++)
        if (outbox->episodes[i].tag < 0 && outbox->episodes[i].kind == kind && !strcmp(outbox->episodes[i].name, name))
            return (int)i;
    return -1;
}

struct episode *outbox_add_episode(struct outbox *outbox, const char *name, int tag, enum alarm_kind kind)
{
    mem_grow(&outbox->episodes, &outbox->capacity, outbox->count + 1, sizeof(*outbox->episodes));
    if (tag >= 0)
        outbox->by_alarm[(size_t)tag * ALARM_KINDS + (size_t)kind] = (int)outbox->count + 1;
    struct episode *episode = &outbox->episodes[outbox->count++];
    *episode = (struct episode){ .name = mem_strdup(name), .tag = tag, .kind = kind, .value = NAN, .limit = NAN };
    return episode;
}

static void remove_episode(struct outbox *outbox, size_t index)
{
    struct episode *gone = &outbox->episodes[index], *last = &outbox->episodes[outbox->count - 1];
    for (size_t i = 0; i < outbox->plant->notify->recipient_count; i++)
        for (size_t k = 0; k < outbox->boxes[i].waiting.count; k++) {
            int *of = &outbox->boxes[i].waiting.at[k].episode;
            *of = *of == (int)index ? -1 : *of == (int)outbox->count - 1 ? (int)index : *of;
        }
    mem_free(gone->name);
    if (gone->tag >= 0)
        outbox->by_alarm[(size_t)gone->tag * ALARM_KINDS + (size_t)gone->kind] = 0;
    if (gone != last) {
        *gone = *last;
        if (gone->tag >= 0)
            outbox->by_alarm[(size_t)gone->tag * ALARM_KINDS + (size_t)gone->kind] = (int)index + 1;
    }
    *last = (struct episode){ 0 };
    outbox->count--;
    outbox->dirty = true;
}

/* --- recipients ------------------------------------------------------------------------------------------------------------- */

static struct outbox_item item_of(const struct episode *episode)
{
    return (struct outbox_item){ .name = mem_strdup(episode->name),
                                 .tag = episode->tag,
                                 .kind = episode->kind,
                                 .priority = episode->priority,
                                 .status = episode->status,
                                 .value = episode->value,
                                 .limit = episode->limit,
                                 .raised_us = episode->raised_us };
}

static void queue_item(struct outbox *outbox, int recipient, const struct episode *episode, int step, int64_t now_us)
{
    struct recipient_box *box = &outbox->boxes[recipient];
    int index = (int)(episode - outbox->episodes);
    /* true: a notification of this alarm was already made, or this is a later escalation step; the alarm is then queued only if
       it is not in the recipient's queue yet */
    bool may_wait = step > 0 || episode->told_us;
    for (size_t i = 0; may_wait && i < box->waiting.count; i++)
        if (box->waiting.at[i].episode == index)
            return;
    outbox->dirty = true;
    if (outbox->items >= OUTBOX_ITEMS) {
        outbox->lost++;
        box->left_out++;
        return;
    }
    if (box->waiting.count == 0)
        box->since_us = now_us;
    mem_grow(&box->waiting.at, &box->waiting.capacity, box->waiting.count + 1, sizeof(*box->waiting.at));
    struct queued_item *item = &box->waiting.at[box->waiting.count++];
    *item = (struct queued_item){ item_of(episode), index };
    item->said.step = step;
    outbox->items++;
}

static void tell(struct outbox *outbox, struct episode *episode, const struct notify_step *step, int number, int64_t now_us)
{
    for (size_t i = 0; i < outbox->plant->notify->recipient_count; i++) {
        uint32_t bit = UINT32_C(1) << i;
        bool is_told = number == 0 && (episode->told & bit);
        if (!(step->to & bit) || is_told || outbox->plant->notify->recipients[i].kind == NOTIFY_ALERTMANAGER)
            continue;
        queue_item(outbox, (int)i, episode, number, now_us);
        episode->told |= bit;
        episode->told_us = now_us;
    }
}

/* Queues the notifications of all escalation steps of an alarm that are due at now_us. */
static void advance(struct outbox *outbox, struct episode *episode, int64_t now_us)
{
    const struct plant_notify *notify = outbox->plant->notify;
    for (size_t i = 0; i < notify->rule_count; i++) {
        const struct notify_rule *rule = &notify->rules[i];
        while (episode->rules >> i & 1 && episode->steps[i] < rule->step_count &&
               now_us - episode->began_us >= (int64_t)(rule->steps[episode->steps[i]].after_min * 60 * (double)S)) {
            tell(outbox, episode, &rule->steps[episode->steps[i]], episode->steps[i], now_us);
            episode->steps[i]++;
            outbox->dirty = true;
        }
    }
}

static void begin(struct outbox *outbox, struct episode *episode, int64_t now_us)
{
    int64_t told_us = episode->told_us;
    bool repeats = told_us && now_us - told_us < OUTBOX_REPEAT_US && now_us >= told_us;
    episode->rules = rules_for(outbox->plant, episode->name, episode->tag, episode->priority, now_us);
    episode->began_us = repeats ? told_us + OUTBOX_REPEAT_US : now_us;
    episode->ended_us = 0;
    episode->told = 0;
    memset(episode->steps, 0, sizeof(episode->steps));
    advance(outbox, episode, now_us);
}

/* --- alarms ----------------------------------------------------------------------------------------------------------------- */

static bool needs_somebody(const struct alarm *alarm)
{
    return !alarm->state.aside && (alarm->rule.acknowledges ? alarm->state.unacknowledged : alarm->state.active);
}

static void mark_alertmanagers(struct outbox *outbox, int64_t now_us)
{
    for (size_t i = 0; i < outbox->plant->notify->recipient_count; i++) {
        struct recipient_box *box = &outbox->boxes[i];
        if (!box->changed)
            box->since_us = now_us;
        box->changed = true;
    }
}

static void end(struct episode *episode, const struct alarm *alarm, int64_t now_us)
{
    bool acknowledged = alarm->rule.acknowledges && !alarm->state.aside && !(alarm->rule.forgets && !alarm->state.active);
    episode->ended_us = now_us;
    if (acknowledged)
        episode->told_us = 0;
}

void outbox_put(struct outbox *outbox, const struct alarm *alarm, bool restored, int64_t now_us)
{
    int index = outbox_find(outbox, alarm->name, alarm->tag, alarm->kind);
    bool needed = needs_somebody(alarm);
    int64_t raised_us = alarm->raised_utc_ns / 1000;
    enum alarm_status status = alarm_status_of(alarm);
    bool known = index >= 0, shown = alarm_status_is_annunciated(status);
    struct episode *episode = known ? &outbox->episodes[index] : NULL;
    bool came_and_went = !restored && !needed && !alarm->state.aside && raised_us > (known ? episode->raised_us : 0) &&
                         now_us - raised_us < OUTBOX_REPEAT_US;
    if (!known && !needed && !came_and_went && !shown)
        return;
    if (!known)
        episode = outbox_add_episode(outbox, alarm->name, alarm->tag, alarm->kind);
    bool begins = (needed && (!known || episode->ended_us)) || came_and_went;
    if (episode->status != status || begins)
        mark_alertmanagers(outbox, now_us);
    episode->seen = true;
    episode->priority = alarm->priority;
    episode->status = status;
    episode->value = alarm->value;
    episode->limit = alarm->limit;
    episode->raised_us = raised_us;
    episode->aside = alarm->state.aside != 0;
    episode->cleared_us = shown ? 0 : episode->cleared_us ? episode->cleared_us : now_us;
    if (begins)
        begin(outbox, episode, now_us);
    else if (!known)
        episode->rules = rules_for(outbox->plant, episode->name, episode->tag, episode->priority, now_us);
    if (!needed && !episode->ended_us)
        end(episode, alarm, now_us);
    outbox->dirty = true;
}

void outbox_end_unseen(struct outbox *outbox, int64_t now_us)
{
    for (size_t i = 0; i < outbox->count; i++) {
        struct episode *episode = &outbox->episodes[i];
        if (episode->seen || (episode->ended_us && episode->cleared_us))
            continue;
        episode->status = ALARM_NORMAL;
        episode->ended_us = episode->ended_us ? episode->ended_us : now_us;
        episode->cleared_us = episode->cleared_us ? episode->cleared_us : now_us;
        mark_alertmanagers(outbox, now_us);
        outbox->dirty = true;
    }
}

/* --- passing of time -------------------------------------------------------------------------------------------------------- */

/* Drops all but the first `kept` alarms of a message that cannot be delivered. */
static void drop_alarms(struct outbox *outbox, struct recipient_box *box, size_t kept)
{
    size_t dropped = box->batch_count - kept;
    outbox->lost += (int64_t)dropped;
    outbox->items -= dropped;
    box->left_out += (int64_t)dropped;
    while (box->batch_count > kept)
        mem_free(box->batch[--box->batch_count].name);
    if (kept == 0)
        free_batch(box);
    box->attempts = 0;
    outbox->dirty = true;
}

static void replace_later(struct outbox *outbox, int64_t *time_us, int64_t latest_us, int64_t new_us)
{
    if (*time_us <= latest_us)
        return;
    *time_us = new_us;
    outbox->dirty = true;
}

/* Corrects times that are in the future because the wall clock was set back, so that outbox_tick() and outbox_next() can compare
   them with now_us. Does not correct told_us: begin() ignores a told_us in the future. */
static void correct_future(struct outbox *outbox, int64_t now_us)
{
    for (size_t i = 0; i < outbox->count; i++) {
        struct episode *episode = &outbox->episodes[i];
        replace_later(outbox, &episode->began_us, now_us + OUTBOX_REPEAT_US, now_us);
        replace_later(outbox, &episode->cleared_us, now_us, now_us); /* Alertmanager would show the alert as active */
    }
    for (size_t i = 0; i < outbox->plant->notify->recipient_count; i++) {
        struct recipient_box *box = &outbox->boxes[i];
        replace_later(outbox, &box->since_us, now_us, 0);                /* the queued alarms are due */
        replace_later(outbox, &box->sent_us, now_us, 0);                 /* no pause; Alertmanager gets all ended alarms again */
        replace_later(outbox, &box->retry_us, now_us + RETRY_MAX_US, 0); /* the retry is due */
        /* outbox_sent() copies the time of Alertmanager's message to sent_us, which is then set to 0 */
        if (outbox->plant->notify->recipients[i].kind != NOTIFY_ALERTMANAGER)
            replace_later(outbox, &box->batch_us, now_us, now_us);
    }
}

void outbox_tick(struct outbox *outbox, int64_t now_us)
{
    correct_future(outbox, now_us);
    for (size_t i = outbox->count; i-- > 0;) {
        struct episode *episode = &outbox->episodes[i];
        if (!episode->ended_us)
            advance(outbox, episode, now_us);
        else if (episode->cleared_us && now_us - episode->cleared_us > FORGET_US)
            remove_episode(outbox, i);
    }
    for (size_t i = 0; i < outbox->plant->notify->recipient_count; i++) {
        struct recipient_box *box = &outbox->boxes[i];
        /* a message to Alertmanager is never given up because of its age: each such message has the present state of all
           alarms, so it does not become outdated */
        bool keeps = outbox->plant->notify->recipients[i].kind == NOTIFY_ALERTMANAGER;
        if (!keeps && box->batch_count > 0 && box->attempts > 0 && now_us - box->batch_us > OUTBOX_KEEP_US)
            drop_alarms(outbox, box, 0);
    }
}

/* --- messages --------------------------------------------------------------------------------------------------------------- */

static int by_urgency(const void *pa, const void *pb)
{
    const struct outbox_item *a = pa, *b = pb;
    if (a->priority != b->priority)
        return a->priority - b->priority;
    return a->raised_us != b->raised_us ? (a->raised_us < b->raised_us ? -1 : 1) : strcmp(a->name, b->name);
}

/* Returns true if enough time has passed since the oldest queued alarm was queued. */
static bool is_gathered(const struct outbox *outbox, const struct recipient_box *box, int64_t now_us)
{
    return now_us - box->since_us >= (int64_t)(outbox->plant->notify->gather_s * (double)S);
}

static bool is_due(const struct outbox *outbox, const struct recipient_box *box, int64_t now_us)
{
    const struct plant_notify *notify = outbox->plant->notify;
    int best = ALARM_PRIORITIES + 1;
    for (size_t i = 0; i < box->waiting.count; i++)
        best = box->waiting.at[i].said.priority < best ? box->waiting.at[i].said.priority : best;
    bool paused = box->sent_us && now_us - box->sent_us < (int64_t)(notify->pause_s * (double)S);
    return box->waiting.count > 0 && is_gathered(outbox, box, now_us) && (!paused || best < box->last_priority);
}

static void make_id(struct outbox *outbox, int recipient, int64_t now_us)
{
    struct recipient_box *box = &outbox->boxes[recipient];
    snprintf(box->id, sizeof(box->id), "%llx.%llx.%x", (unsigned long long)now_us, (unsigned long long)++outbox->made, (unsigned)recipient);
}

/* Makes a message of the alarms queued for a recipient, with their present states. Leaves out alarms that were shelved or
   suppressed after they were queued. */
static void make_batch(struct outbox *outbox, int recipient, int64_t now_us)
{
    struct recipient_box *box = &outbox->boxes[recipient];
    box->batch = mem_array(box->waiting.count, sizeof(*box->batch));
    for (size_t i = 0; i < box->waiting.count; i++) {
        struct queued_item *item = &box->waiting.at[i];
        const struct episode *episode = item->episode >= 0 ? &outbox->episodes[item->episode] : NULL;
        if (episode && episode->aside) {
            mem_free(item->said.name);
            outbox->items--;
            continue;
        }
        if (episode) {
            item->said.status = episode->status;
            item->said.ended_us = episode->ended_us;
        }
        box->batch[box->batch_count++] = item->said;
    }
    box->waiting.count = 0;
    qsort(box->batch, box->batch_count, sizeof(*box->batch), by_urgency);
    box->batch_us = now_us;
    box->attempts = 0;
    make_id(outbox, recipient, now_us);
    outbox->dirty = true;
    if (box->batch_count == 0)
        free_batch(box);
}

static bool goes_to(const struct plant_notify *notify, const struct episode *episode, int recipient)
{
    for (size_t i = 0; i < notify->rule_count; i++)
        for (size_t k = 0; k < notify->rules[i].step_count && (episode->rules >> i & 1); k++)
            if (notify->rules[i].steps[k].to >> recipient & 1)
                return true;
    return false;
}

/* Makes a message for Alertmanager with all active alarms, and with those that ended since the last message. Returns false if
   there are none, or if no message is due. */
static bool make_alerts(struct outbox *outbox, int recipient, int64_t now_us)
{
    struct recipient_box *box = &outbox->boxes[recipient];
    bool due = (box->changed && is_gathered(outbox, box, now_us)) || now_us - box->sent_us >= OUTBOX_REFRESH_US;
    if (!due || now_us < box->retry_us)
        return false;
    free_batch(box);
    box->batch = mem_array(outbox->count + 1, sizeof(*box->batch));
    for (size_t i = 0; i < outbox->count; i++) {
        const struct episode *episode = &outbox->episodes[i];
        if ((episode->cleared_us && episode->cleared_us < box->sent_us) || !goes_to(outbox->plant->notify, episode, recipient))
            continue;
        box->batch[box->batch_count] = item_of(episode);
        box->batch[box->batch_count++].ended_us = episode->cleared_us;
    }
    box->batch_us = now_us;
    box->changed = false;
    if (box->batch_count == 0) {
        free_batch(box);
        box->sent_us = now_us;
    }
    return box->batch_count > 0;
}

bool outbox_next(struct outbox *outbox, int recipient, int64_t now_us, struct outbox_message *out)
{
    struct recipient_box *box = &outbox->boxes[recipient];
    correct_future(outbox, now_us);
    if (outbox->plant->notify->recipients[recipient].kind == NOTIFY_ALERTMANAGER) {
        if (!make_alerts(outbox, recipient, now_us))
            return false;
    } else if (box->batch_count == 0 && is_due(outbox, box, now_us)) {
        make_batch(outbox, recipient, now_us);
    } else if (now_us < box->retry_us) {
        return false;
    }
    *out = (struct outbox_message){ .items = box->batch, .count = box->batch_count, .left_out = box->left_out, .made_us = box->batch_us };
    memcpy(out->id, box->id, sizeof(out->id));
    return box->batch_count > 0;
}

void outbox_sent(struct outbox *outbox, int recipient, int64_t now_us)
{
    struct recipient_box *box = &outbox->boxes[recipient];
    bool alerts = outbox->plant->notify->recipients[recipient].kind == NOTIFY_ALERTMANAGER;
    box->last_priority = box->batch_count > 0 ? box->batch[0].priority : ALARM_PRIORITIES;
    outbox->items -= alerts ? 0 : box->batch_count;
    box->sent_us = alerts ? box->batch_us : now_us;
    free_batch(box);
    box->attempts = 0;
    box->retry_us = 0;
    box->left_out = 0;
    outbox->dirty = true;
}

enum outbox_failure outbox_failed(struct outbox *outbox, int recipient, bool is_refused, int64_t now_us)
{
    struct recipient_box *box = &outbox->boxes[recipient];
    bool alerts = outbox->plant->notify->recipients[recipient].kind == NOTIFY_ALERTMANAGER;
    if (is_refused && !alerts) {
        drop_alarms(outbox, box, box->batch_count > OUTBOX_SHORT ? OUTBOX_SHORT : 0);
        make_id(outbox, recipient, now_us);
        box->retry_us = 0;
        return box->batch_count > 0 ? OUTBOX_SHORTENED : OUTBOX_DROPPED;
    }
    int64_t wait_us = S << (box->attempts < 6 ? box->attempts : 6);
    box->attempts++;
    box->retry_us = now_us + (wait_us < RETRY_MAX_US ? wait_us : RETRY_MAX_US);
    if (alerts) {
        free_batch(box);
        box->changed = true;
    }
    return OUTBOX_RETRIED;
}

struct outbox_counts outbox_counts(const struct outbox *outbox, int recipient)
{
    const struct recipient_box *box = &outbox->boxes[recipient];
    return (struct outbox_counts){ (int64_t)(box->waiting.count + box->batch_count), outbox->lost };
}

bool outbox_rests(const struct outbox *outbox)
{
    for (size_t i = 0; i < outbox->plant->notify->recipient_count; i++) {
        bool alerts = outbox->plant->notify->recipients[i].kind == NOTIFY_ALERTMANAGER;
        if ((alerts && outbox->boxes[i].changed) || outbox->boxes[i].batch_count > 0)
            return false;
    }
    return outbox->count == 0 && outbox->items == 0;
}

bool outbox_is_changed(struct outbox *outbox)
{
    bool dirty = outbox->dirty;
    outbox->dirty = false;
    return dirty;
}
