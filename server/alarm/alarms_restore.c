/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Restores alarm states from an earlier run, from the plant before a reload, or from another daemon. Also counts alarms by state. */
#include <math.h>
#include <string.h>

#include "alarm/alarms_impl.h"
#include "base/mem.h"

/* Adapts a restored alarm state to the plant's alarm settings. If operators cannot act on alarms (by_hand false), drops the
   states shelved and out of service, because no operator could end them. */
static void fit_to_rule(struct alarm *alarm, bool by_hand)
{
    if (!alarm->rule.acknowledges)
        alarm->state.unacknowledged = false;
    if (!alarm->rule.latches)
        alarm->state.latched = false;
    if (!by_hand)
        alarm->state.aside &= ALARM_ASIDE_SUPPRESSED | ALARM_ASIDE_CARRIED;
    if (!(alarm->state.aside & ALARM_ASIDE_SHELVED))
        alarm->until = (struct instant){ 0 };
}

static void take(struct alarms *alarms, int index, const struct alarm *from)
{
    struct alarm *alarm = &alarms->list[index];
    alarm->state = from->state;
    alarm->value = from->value;
    alarm->raised_utc_ns = from->raised_utc_ns;
    alarm->changed_utc_ns = from->changed_utc_ns;
    alarm->until = from->until;
    memcpy(alarm->who, from->who, sizeof(alarm->who));
    memcpy(alarm->reason, from->reason, sizeof(alarm->reason));
    fit_to_rule(alarm, alarms->plant->alarms == ALARMS_LOCAL);
    if ((alarm->tag < 0 || alarms->plant->tags[alarm->tag].alarms.suppressed_by < 0) && alarm->state.aside & ALARM_ASIDE_SUPPRESSED)
        alarm_state_step(&alarm->state, &alarm->rule, ALARM_UNSUPPRESS);
    if (alarm->kind != ALARM_BAD || alarms->devices->of_tag[alarm->tag] < 0)
        alarm_state_step(&alarm->state, &alarm->rule, ALARM_CALL);
    alarms->carried += (alarm->state.aside & ALARM_ASIDE_CARRIED) != 0;
    alarm->condition.active = alarm->state.active;
    if (alarm_status_of(alarm) != ALARM_NORMAL)
        alarms_touch(alarms, index);
    alarms_watch(alarms, index);
}

void alarms_restore(struct alarms *alarms, int index, const struct alarm *saved, struct instant now)
{
    struct alarm *alarm = &alarms->list[index], from = *saved;
    /* the shelving time may have ended while the daemon was not running; the next alarms_tick() then ends the shelving, because
       it is set to end in 1 ns. If the clock is years behind, the shelving still ends after the longest time allowed */
    int64_t rest_ns = from.until.utc_ns > now.utc_ns ? from.until.utc_ns - now.utc_ns : 1;
    if (from.until.utc_ns)
        from.until.mono_ns = now.mono_ns + (rest_ns > ALARM_LONGEST_SHELF_NS ? ALARM_LONGEST_SHELF_NS : rest_ns);
    alarm->until_restored = true;
    alarm->acknowledged_there = alarm->rule.forgets && from.state.active && !from.state.unacknowledged;
    alarm->acknowledgement_bad = true; /* until the acknowledgement bit's first usable sample */
    /* held true: the alarm keeps its restored state until its tag's next sample; BAD and LINK alarms are never held */
    alarm->held = alarm->kind != ALARM_BAD && alarm->kind != ALARM_LINK;
    alarm->raised_mono_ns = now.mono_ns - (from.raised_utc_ns ? now.utc_ns - from.raised_utc_ns : 0);
    take(alarms, index, &from);
}

static bool same_limit(const struct alarm *a, const struct alarm *b)
{
    return !memcmp(&a->limit, &b->limit, sizeof(a->limit)) && !memcmp(&a->delays, &b->delays, sizeof(a->delays));
}

double alarm_value_in_unit(double value, const char *was, const char *is)
{
    struct unit_change change = { 0 };
    return *was && *is && units_compare(was, is, &change) > UNITS_CONVERT ? NAN : unit_change_value(&change, value);
}

/* Copies the newest sample of each tag from the alarms of the old plant. Also copies the tag's device status, if the
   tag still belongs to the same device. */
static void adopt_seen(struct alarms *alarms, const struct alarms *before)
{
    for (size_t i = 0; i < before->plant->tag_count; i++) {
        int tag = plant_find_tag(alarms->plant, before->plant->tags[i].name);
        if (tag < 0)
            continue;
        int of = before->devices->of_tag[i], now_of = alarms->devices->of_tag[tag];
        alarms->seen[tag] = before->seen[i];
        alarms->seen[tag].value =
            alarm_value_in_unit(before->seen[i].value, plant_tag_unit(before->plant, (int)i), plant_tag_unit(alarms->plant, tag));
        if (of >= 0 && now_of >= 0 && !strcmp(before->devices->list[of].name, alarms->devices->list[now_of].name))
            devices_put(alarms->devices, tag, (enum device_status)before->devices->statuses[i], before->devices->list[of].back_ns);
    }
}

const char *alarm_unit(const struct alarms *alarms, const struct alarm *alarm)
{
    return plant_tag_unit(alarms->plant, alarm->tag);
}

void alarms_adopt(struct alarms *alarms, const struct alarms *before)
{
    adopt_seen(alarms, before);
    for (size_t i = 0; i < alarms->plant->tag_count; i++)
        alarms->seen[i].recheck = true;
    for (size_t i = 0; i < before->count; i++) {
        const struct alarm *from = &before->list[i];
        int index = alarms_find_named(alarms, from->name, from->kind);
        if (index < 0)
            continue;
        struct alarm *alarm = &alarms->list[index];
        alarm->held = from->held;
        alarm->acknowledged_there = from->acknowledged_there;
        alarm->acknowledgement_bad = from->acknowledgement_bad;
        alarm->until_restored = from->until_restored;
        alarm->raised_mono_ns = from->raised_mono_ns;
        memcpy(alarm->recent_ns, from->recent_ns, sizeof(alarm->recent_ns));
        alarm->raised_count = from->raised_count;
        if (same_limit(alarm, from))
            alarm->condition = from->condition;
        take(alarms, index, from);
        alarm->value = alarm_value_in_unit(from->value, alarm_unit(before, from), alarm_unit(alarms, alarm));
    }
}

bool alarms_is_ended(const struct alarms *alarms, const struct alarm *before)
{
    int index = alarms_find_named(alarms, before->name, before->kind);
    return alarm_status_of(before) != ALARM_NORMAL && (index < 0 || alarm_status_of(alarms_at(alarms, index)) == ALARM_NORMAL);
}

static void set_as_told(struct alarms *alarms, int index, const struct alarm *told)
{
    struct alarm *alarm = &alarms->list[index];
    alarm->state = told->state;
    alarm->acknowledged_there = told->acknowledged_there;
    alarm->held = told->held;
    alarm->value = told->value;
    alarm->raised_utc_ns = told->raised_utc_ns;
    alarm->raised_mono_ns = told->raised_mono_ns;
    alarm->changed_utc_ns = told->changed_utc_ns;
    alarm->until = told->until;
    memcpy(alarm->who, told->who, sizeof(alarm->who));
    memcpy(alarm->reason, told->reason, sizeof(alarm->reason));
    alarms_touch(alarms, index);
}

bool alarms_mirror(struct alarms *alarms, const struct alarm *list, size_t count, bool whole)
{
    bool *named = mem_array(alarms->count + 1, sizeof(*named)), good = true;
    for (size_t i = 0; i < count && good; i++) {
        int index = alarms_find_named(alarms, list[i].name, list[i].kind);
        good = index >= 0;
        if (good)
            named[index] = true;
    }
    for (size_t i = 0; good && whole && i < alarms->count; i++)
        if (!named[i] && alarm_status_of(&alarms->list[i]) != ALARM_NORMAL) {
            alarms->list[i].state = (struct alarm_state){ 0 };
            alarms->list[i].held = false;
            alarms_touch(alarms, (int)i);
        }
    for (size_t i = 0; good && i < count; i++)
        set_as_told(alarms, alarms_find_named(alarms, list[i].name, list[i].kind), &list[i]);
    mem_free(named);
    return good;
}

void alarms_lead(struct alarms *alarms, struct instant now)
{
    memset(alarms->seen, 0, alarms->plant->tag_count * sizeof(*alarms->seen));
    alarms->carried = 0;
    for (size_t i = 0; i < alarms->count; i++) {
        const struct alarm as_told = alarms->list[i];
        alarms_restore(alarms, (int)i, &as_told, now);
    }
}

static bool chatters(const struct alarm *alarm, int64_t now_mono_ns)
{
    return alarm->raised_count >= ALARM_RECENT && now_mono_ns - alarm->recent_ns[alarm->raised_count % ALARM_RECENT] < ALARM_CHATTERING_NS;
}

void alarms_counts(const struct alarms *alarms, int64_t now_mono_ns, struct alarm_counts *out)
{
    *out = (struct alarm_counts){ .statuses[ALARM_NORMAL] = (int)alarms->count };
    for (int i = alarms->newest; i >= 0; i = alarms->list[i].older) {
        const struct alarm *alarm = &alarms->list[i];
        enum alarm_status status = alarm_status_of(alarm);
        bool calls = alarm_status_is_annunciated(status);
        out->statuses[ALARM_NORMAL]--;
        out->statuses[status]++;
        out->active += calls && !alarm_status_is_cleared(status);
        out->held += calls && alarm->held;
        out->priorities[alarm->priority - 1] += calls;
        out->standing += calls && alarm->state.active && now_mono_ns - alarm->raised_mono_ns >= ALARM_STANDING_NS;
        out->chattering += chatters(alarm, now_mono_ns);
    }
}
