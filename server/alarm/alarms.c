/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The alarms of a plant: how they are created, and how samples, time and operators change them. */
#include "alarm/alarms_impl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "value/quality.h"

enum { LONGEST_RETURN_S = 60 };
static const int64_t LINK_DELAY_NS = INT64_C(10000000000);

/* --- creating the alarms -------------------------------------------------------------------------------------------------------- */

static void add_feed(struct alarms *alarms, int tag, int alarm, enum feed_role role)
{
    mem_grow(&alarms->feeds, &alarms->feed_capacity, alarms->feed_count + 1, sizeof(*alarms->feeds));
    alarms->feeds[alarms->feed_count++] = (struct feed){ tag, alarm, role };
}

static int64_t ns_of(double s)
{
    return (int64_t)(s * 1e9);
}

static int add_alarm(struct alarms *alarms, int tag, enum alarm_kind kind, double limit)
{
    const struct plant_alarm_settings *alarm_settings = &alarms->plant->tags[tag].alarms.settings;
    int index = (int)alarms->count;
    mem_grow(&alarms->list, &alarms->capacity, alarms->count + 1, sizeof(*alarms->list));
    alarms->list[alarms->count++] = (struct alarm){
        .name = alarms->plant->tags[tag].name,
        .tag = tag,
        .kind = kind,
        .priority = alarm_priority(&alarms->plant->tags[tag], kind),
        .limit = limit,
        .value = NAN,
        .rule = { .acknowledges = alarms->plant->alarms == ALARMS_LOCAL, .latches = alarm_settings->latch && kind != ALARM_BAD },
        .delays = { ns_of(alarm_settings->on_delay_s), ns_of(alarm_settings->off_delay_s) },
        .older = -1,
        .newer = -1,
    };
    return index;
}

static void add_suppression(struct alarms *alarms, int index)
{
    int by = alarms->plant->tags[alarms->list[index].tag].alarms.suppressed_by;
    if (by >= 0)
        add_feed(alarms, by, index, FEED_SUPPRESSES);
}

static void add_bad(struct alarms *alarms, int tag)
{
    int index = add_alarm(alarms, tag, ALARM_BAD, NAN);
    add_feed(alarms, tag, index, FEED_BADNESS);
    add_suppression(alarms, index);
}

/* Creates a device's LINK alarm (raised when the device does not answer), or adapts it to another tag of the device. Its delay
   is the shortest of the tags' delays, but at least least_on_ns. It is one level less urgent than the most urgent tag. */
static void add_link(struct alarms *alarms, struct alarm_device *device, int tag, int64_t least_on_ns)
{
    const struct plant_alarm_settings *settings = &alarms->plant->tags[tag].alarms.settings;
    int priority = (settings->priority ? settings->priority : ALARM_PRIORITY_DEFAULT) + 1;
    int64_t on_ns = ns_of(settings->on_delay_s), off_ns = ns_of(settings->off_delay_s);
    priority = priority > ALARM_PRIORITIES ? ALARM_PRIORITIES : priority;
    on_ns = on_ns < least_on_ns ? least_on_ns : on_ns;
    if (device->alarm >= 0) {
        struct alarm *link = &alarms->list[device->alarm];
        link->priority = priority < link->priority ? priority : link->priority;
        link->delays.on_ns = on_ns < link->delays.on_ns ? on_ns : link->delays.on_ns;
        link->delays.off_ns = off_ns < link->delays.off_ns ? off_ns : link->delays.off_ns;
        return;
    }
    const struct alarm link = { .name = device->name,
                                .tag = -1,
                                .kind = ALARM_LINK,
                                .priority = priority,
                                .limit = NAN,
                                .value = NAN,
                                .rule = { .acknowledges = alarms->plant->alarms == ALARMS_LOCAL },
                                .delays = { on_ns, off_ns },
                                .older = -1,
                                .newer = -1 };
    device->alarm = (int)alarms->count;
    mem_grow(&alarms->list, &alarms->capacity, alarms->count + 1, sizeof(*alarms->list));
    alarms->list[alarms->count++] = link;
}

static bool never_stale(const struct alarms *alarms, size_t tag)
{
    return alarms->plant->tags[tag].validity.stale_s >= PLANT_NEVER_STALE_S;
}

/* Creates the LINK alarm of every device (raised when the device does not answer). Its delay comes from the device's tags that
   have a BAD alarm (raised when the value is Bad), or from all its tags if none has one. A replayed file ends normally, so its
   source gets a LINK alarm only if one of its tags has a BAD alarm. */
static void add_links(struct alarms *alarms)
{
    const struct plant *plant = alarms->plant;
    size_t count = alarms->count, tag_count = plant->tag_count;
    alarms->devices = devices_create(plant);
    struct alarm_device *list = alarms->devices->list;
    const int *of_tag = alarms->devices->of_tag;
    for (size_t i = 0; i < count; i++)
        if (alarms->list[i].kind == ALARM_BAD && of_tag[alarms->list[i].tag] >= 0)
            add_link(alarms, &list[of_tag[alarms->list[i].tag]], alarms->list[i].tag, 0);
    size_t with_bad = alarms->count;
    for (size_t i = 0; i < tag_count; i++) {
        struct alarm_device *device = of_tag[i] < 0 ? NULL : &list[of_tag[i]];
        const char *kind = device ? plant->sources[device->source].kind : NULL;
        if (device && (device->alarm < 0 || device->alarm >= (int)with_bad) && !(kind && !strcmp(kind, "replay")))
            add_link(alarms, device, (int)i, LINK_DELAY_NS);
    }
    /* LINK alarms of devices with a tag that never becomes stale get a delay of at least LINK_DELAY_NS. It keeps short
       connection losses from raising the alarm. */
    for (size_t i = 0; i < tag_count; i++) {
        struct alarm *link = of_tag[i] < 0 || list[of_tag[i]].alarm < 0 ? NULL : &alarms->list[list[of_tag[i]].alarm];
        if (link && never_stale(alarms, i) && link->delays.on_ns < LINK_DELAY_NS)
            link->delays.on_ns = LINK_DELAY_NS;
    }
}

static void add_limits(struct alarms *alarms, int tag)
{
    bool any = false;
    for (int i = 0; i < LIMIT_COUNT; i++) {
        double limit = alarms->plant->tags[tag].alarms.limits[i];
        if (isnan(limit))
            continue;
        int index = add_alarm(alarms, tag, (enum alarm_kind)(1 + i), limit);
        add_feed(alarms, tag, index, FEED_VALUE);
        add_suppression(alarms, index);
        any = true;
    }
    if (any)
        add_bad(alarms, tag);
}

static enum alarm_kind kind_of(const struct plant_mirror *mirror)
{
    return mirror->limit == LIMIT_COUNT ? ALARM_ON : (enum alarm_kind)(1 + mirror->limit);
}

/* Creates alarms for the bit tags through which another alarm system reports its alarms. `mirrors` has the indices of these bit
   tags. Each alarm belongs to the tag that the other system monitors, not to the bit tag. A bit of Bad quality raises the alarm
   as well. */
static void add_mirrored(struct alarms *alarms, const int *mirrors, size_t count)
{
    const struct plant *plant = alarms->plant;
    for (size_t i = 0; i < count; i++) {
        const struct plant_mirror *mirror = &plant->tags[mirrors[i]].alarms.mirror;
        if (mirror->acknowledged)
            continue;
        double limit = mirror->limit == LIMIT_COUNT ? NAN : plant->tags[mirror->tag].alarms.limits[mirror->limit];
        int index = add_alarm(alarms, mirror->tag, kind_of(mirror), limit);
        alarms->list[index].rule.latches = false;
        alarms->list[index].delays = (struct condition_delays){ 0, 0 };
        add_feed(alarms, mirrors[i], index, FEED_BIT);
        for (size_t k = 0; k < count; k++) {
            const struct plant_mirror *other = &plant->tags[mirrors[k]].alarms.mirror;
            if (!other->acknowledged || kind_of(other) != kind_of(mirror))
                continue;
            alarms->list[index].rule.acknowledges = alarms->list[index].rule.forgets = true;
            add_feed(alarms, mirrors[k], index, FEED_ACKNOWLEDGED);
        }
    }
}

static int by_mirrored(const void *pa, const void *pb, void *plant)
{
    const struct plant_tag *tags = ((const struct plant *)plant)->tags;
    int a = *(const int *)pa, b = *(const int *)pb, order = tags[a].alarms.mirror.tag - tags[b].alarms.mirror.tag;
    return order ? order : a - b;
}

static void add_mirrors(struct alarms *alarms)
{
    const struct plant *plant = alarms->plant;
    int *mirrors = mem_array(plant->tag_count, sizeof(*mirrors));
    size_t count = 0;
    for (size_t i = 0; i < plant->tag_count; i++)
        if (plant->tags[i].alarms.mirror.tag >= 0)
            mirrors[count++] = (int)i;
    qsort_r(mirrors, count, sizeof(*mirrors), by_mirrored, (void *)plant);
    for (size_t i = 0, end; i < count; i = end) {
        int tag = plant->tags[mirrors[i]].alarms.mirror.tag;
        for (end = i; end < count && plant->tags[mirrors[end]].alarms.mirror.tag == tag;)
            end++;
        add_mirrored(alarms, mirrors + i, end - i);
    }
    for (size_t i = 0; i < count; i++)
        add_bad(alarms, mirrors[i]);
    mem_free(mirrors);
}

static int by_tag(const void *pa, const void *pb)
{
    const struct feed *a = pa, *b = pb;
    return a->tag != b->tag ? a->tag - b->tag : a->alarm != b->alarm ? a->alarm - b->alarm : (int)a->role - (int)b->role;
}

static int by_tag_and_kind(const void *pa, const void *pb, void *list_ptr)
{
    const struct alarm *list = list_ptr, *a = &list[*(const int *)pa], *b = &list[*(const int *)pb];
    return a->tag != b->tag ? a->tag - b->tag : (int)a->kind - (int)b->kind;
}

/* Builds the index by tag of alarms and feeds (a feed says which tag's samples an alarm depends on). Tag t owns the positions
   first_alarm[t] to first_alarm[t + 1] - 1 of by_tag, and first_feed[t] to first_feed[t + 1] - 1 of feeds. */
static void index_all(struct alarms *alarms)
{
    size_t tags = alarms->plant->tag_count;
    if (alarms->feed_count > 0)
        qsort(alarms->feeds, alarms->feed_count, sizeof(*alarms->feeds), by_tag);
    alarms->by_tag = mem_array(alarms->count, sizeof(*alarms->by_tag));
    for (size_t i = 0; i < alarms->count; i++)
        alarms->by_tag[i] = (int)i;
    qsort_r(alarms->by_tag, alarms->count, sizeof(*alarms->by_tag), by_tag_and_kind, alarms->list);
    alarms->first_feed = mem_array(tags + 1, sizeof(*alarms->first_feed));
    alarms->first_alarm = mem_array(tags + 1, sizeof(*alarms->first_alarm));
    for (size_t i = 0; i < alarms->feed_count; i++)
        alarms->first_feed[alarms->feeds[i].tag + 1]++;
    for (size_t i = 0; i < alarms->count; i++)
        alarms->first_alarm[alarms->list[i].tag + 1]++;
    for (size_t i = 0; i < tags; i++) {
        alarms->first_feed[i + 1] += alarms->first_feed[i];
        alarms->first_alarm[i + 1] += alarms->first_alarm[i];
    }
}

struct alarms *alarms_create(const struct plant *plant, const struct alarms_listener *listener)
{
    struct alarms *alarms = mem_new(sizeof(*alarms));
    alarms->plant = plant;
    alarms->listener = *listener;
    alarms->newest = -1;
    alarms->seen = mem_array(plant->tag_count, sizeof(*alarms->seen));
    alarms->gravest = mem_array(plant->tag_count, sizeof(*alarms->gravest));
    if (plant->alarms == ALARMS_MIRROR)
        add_mirrors(alarms);
    else
        for (size_t i = 0; i < plant->tag_count; i++)
            add_limits(alarms, (int)i);
    add_links(alarms);
    alarms->noticed = mem_array(plant->tag_count ? plant->tag_count : 1, sizeof(*alarms->noticed));
    index_all(alarms);
    return alarms;
}

void alarms_destroy(struct alarms **pointer)
{
    struct alarms *alarms = *pointer;
    if (!alarms)
        return;
    mem_free(alarms->list);
    mem_free(alarms->feeds);
    mem_free(alarms->by_tag);
    mem_free(alarms->first_feed);
    mem_free(alarms->first_alarm);
    mem_free(alarms->seen);
    mem_free(alarms->noticed);
    devices_destroy(&alarms->devices);
    mem_free(alarms->gravest);
    mem_free(alarms->timed);
    mem_free(alarms);
    *pointer = NULL;
}

/* --- changing one alarm --------------------------------------------------------------------------------------------------------- */

static void unlink_alarm(struct alarms *alarms, int index)
{
    struct alarm *alarm = &alarms->list[index];
    if (alarm->newer >= 0)
        alarms->list[alarm->newer].older = alarm->older;
    if (alarm->older >= 0)
        alarms->list[alarm->older].newer = alarm->newer;
    if (alarms->newest == index)
        alarms->newest = alarm->older;
}

enum alarm_status alarm_status_of(const struct alarm *alarm)
{
    return alarm_state_status(&alarm->state, &alarm->rule);
}

static bool graver(const struct alarm *a, const struct alarm *b)
{
    const struct alarm_grade x = { a->priority, a->kind, alarm_status_of(a) }, y = { b->priority, b->kind, alarm_status_of(b) };
    return alarm_graver(&x, &y);
}

static void find_gravest(struct alarms *alarms, int tag)
{
    const struct alarm *gravest = NULL;
    for (int i = alarms->first_alarm[tag]; i < alarms->first_alarm[tag + 1]; i++) {
        const struct alarm *alarm = &alarms->list[alarms->by_tag[i]];
        if (alarm_status_is_annunciated(alarm_status_of(alarm)) && (!gravest || graver(alarm, gravest)))
            gravest = alarm;
    }
    struct gravest now = { .kind = (uint8_t)(gravest ? gravest->kind : ALARM_NONE),
                           .status = (uint8_t)(gravest ? alarm_status_of(gravest) : ALARM_NORMAL) };
    struct gravest *was = &alarms->gravest[tag];
    if (was->kind == now.kind && was->status == now.status)
        return;
    *was = now;
    if (alarms->listener.of_tag)
        alarms->listener.of_tag(alarms->listener.arg, tag, (enum alarm_kind)now.kind, (enum alarm_status)now.status);
}

/* Gives the alarm the next change number, and moves it to the front of the list of alarms, which is sorted by last change. */
void alarms_touch(struct alarms *alarms, int index)
{
    struct alarm *alarm = &alarms->list[index];
    alarm->number = ++alarms->number;
    if (alarms->newest != index) {
        unlink_alarm(alarms, index);
        alarm->newer = -1;
        alarm->older = alarms->newest;
        if (alarms->newest >= 0)
            alarms->list[alarms->newest].newer = index;
        alarms->newest = index;
    }
    if (alarm->tag >= 0)
        find_gravest(alarms, alarm->tag);
}

void alarms_watch(struct alarms *alarms, int index)
{
    struct alarm *alarm = &alarms->list[index];
    if (alarm->timed || (!condition_is_timed(&alarm->condition) && !alarm->until.mono_ns))
        return;
    mem_grow(&alarms->timed, &alarms->timed_capacity, alarms->timed_count + 1, sizeof(*alarms->timed));
    alarms->timed[alarms->timed_count++] = index;
    alarm->timed = true;
}

static enum alarm_outcome step(struct alarms *alarms, int index, const struct alarm_change *what, int64_t mono_ns)
{
    struct alarm *alarm = &alarms->list[index];
    struct alarm_change change = *what;
    change.before = alarm_status_of(alarm);
    alarms->carried -= (alarm->state.aside & ALARM_ASIDE_CARRIED) != 0;
    enum alarm_outcome outcome = alarm_state_step(&alarm->state, &alarm->rule, what->event);
    alarms->carried += (alarm->state.aside & ALARM_ASIDE_CARRIED) != 0;
    if (outcome != ALARM_CHANGED)
        return outcome;
    alarm->changed_utc_ns = what->utc_ns;
    if (what->event == ALARM_RAISE && !alarm->state.aside)
        alarm->who[0] = alarm->reason[0] = 0;
    if (what->event == ALARM_RAISE) {
        alarm->raised_utc_ns = what->utc_ns;
        alarm->raised_mono_ns = mono_ns;
        alarm->recent_ns[alarm->raised_count++ % ALARM_RECENT] = mono_ns;
        alarm->value = what->value;
    }
    change.alarm = alarm;
    change.after = alarm_status_of(alarm);
    alarms_touch(alarms, index);
    if (alarms->listener.changed)
        alarms->listener.changed(alarms->listener.arg, &change);
    return outcome;
}

/* Mirrors the acknowledgement of the other alarm system: the alarm is acknowledged while the other system's bit says so. If the
   bit is cleared while the alarm is active, the alarm becomes unacknowledged again. */
static void follow_acknowledgement(struct alarms *alarms, int index, struct instant at)
{
    struct alarm *alarm = &alarms->list[index];
    struct alarm_change change = { .event = ALARM_ACKNOWLEDGE, .utc_ns = at.utc_ns, .value = NAN, .who = "", .reason = "" };
    if (!alarm->rule.forgets || !alarm->state.active || alarm->state.unacknowledged != alarm->acknowledged_there)
        return;
    if (!alarm->acknowledged_there) {
        alarm->state.active = false;
        change.event = ALARM_RAISE;
        change.value = alarm->value;
    }
    step(alarms, index, &change, at.mono_ns);
}

/* Returns the lost device whose LINK alarm (the device does not answer) replaces this BAD alarm of one of its tags; NULL: none. */
static const struct alarm_device *carrier_of(const struct alarms *alarms, const struct alarm *alarm)
{
    int of = alarm->kind == ALARM_BAD ? alarms->devices->of_tag[alarm->tag] : -1;
    const struct alarm_device *device = of < 0 ? NULL : &alarms->devices->list[of];
    return device && device_is_lost(device) && alarms->devices->statuses[alarm->tag] == DEVICE_GONE ? device : NULL;
}

static void turned(struct alarms *alarms, int index, double value, struct instant at)
{
    struct alarm *alarm = &alarms->list[index];
    const struct alarm_device *carrier = alarm->condition.active ? carrier_of(alarms, alarm) : NULL;
    alarm->rule.carried = carrier != NULL;
    if (alarm->condition.active && alarm->acknowledgement_bad)
        alarm->acknowledged_there = false; /* the last known acknowledgement was of an earlier alarm */
    step(alarms, index,
         &(struct alarm_change){ .event = alarm->condition.active ? ALARM_RAISE : ALARM_CLEAR,
                                 .utc_ns = at.utc_ns,
                                 .value = value,
                                 .who = "",
                                 .reason = carrier ? carrier->name : "" },
         at.mono_ns);
    follow_acknowledgement(alarms, index, at);
}

/* Ends the alarm's running delay if it is over. The resulting change is dated to the end of the delay, not to `now`. */
static void advance(struct alarms *alarms, int index, struct instant now)
{
    struct alarm *alarm = &alarms->list[index];
    int64_t at_ns;
    if (condition_advance(&alarm->condition, &alarm->delays, now.mono_ns, &at_ns))
        turned(alarms, index, alarm->tag < 0 ? NAN : alarms->seen[alarm->tag].value,
               (struct instant){ at_ns, now.utc_ns - (now.mono_ns - at_ns) });
}

static void put(struct alarms *alarms, int index, enum condition_side side, double value, struct instant now)
{
    struct alarm *alarm = &alarms->list[index];
    advance(alarms, index, now);
    if (condition_put(&alarm->condition, &alarm->delays, side, now.mono_ns))
        turned(alarms, index, value, now);
    alarms_watch(alarms, index);
}

/* --- samples ---------------------------------------------------------------------------------------------------------------- */

static void set_held(struct alarms *alarms, int index, bool held)
{
    if (alarms->list[index].held == held)
        return;
    alarms->list[index].held = held;
    if (alarm_status_of(&alarms->list[index]) != ALARM_NORMAL)
        alarms_touch(alarms, index);
}

static void put_value(struct alarms *alarms, int index, const struct sample_event *event, bool is_bit)
{
    struct alarm *alarm = &alarms->list[index];
    struct instant now = { event->mono_ns, event->utc_ns };
    bool bad = quality_is_bad(event->quality);
    set_held(alarms, index, bad);
    if (bad) {
        advance(alarms, index, now);
        condition_hold(&alarm->condition, now.mono_ns);
    } else if (is_bit) {
        put(alarms, index, event->value != 0 ? CONDITION_BEYOND : CONDITION_CLEAR, event->value, now);
    } else {
        double deadband = alarms->plant->tags[alarm->tag].alarms.settings.deadband;
        put(alarms, index, condition_side(alarm->kind, alarm->limit, deadband, event->value), event->value, now);
    }
}

static void put_sample(struct alarms *alarms, const struct feed *feed, const struct sample_event *event)
{
    bool bad = quality_is_bad(event->quality);
    switch (feed->role) {
    case FEED_VALUE: put_value(alarms, feed->alarm, event, false); break;
    case FEED_BIT: put_value(alarms, feed->alarm, event, true); break;
    case FEED_BADNESS:
        put(alarms, feed->alarm, bad ? CONDITION_BEYOND : CONDITION_CLEAR, NAN, (struct instant){ event->mono_ns, event->utc_ns });
        break;
    case FEED_ACKNOWLEDGED:
        alarms->list[feed->alarm].acknowledgement_bad = bad;
        if (!bad)
            alarms->list[feed->alarm].acknowledged_there = event->value != 0;
        follow_acknowledgement(alarms, feed->alarm, (struct instant){ event->mono_ns, event->utc_ns });
        break;
    case FEED_SUPPRESSES:
        if (!bad)
            step(alarms, feed->alarm,
                 &(struct alarm_change){ .event = event->value != 0 ? ALARM_SUPPRESS : ALARM_UNSUPPRESS,
                                         .utc_ns = event->utc_ns,
                                         .value = NAN,
                                         .who = "",
                                         .reason = alarms->plant->tags[event->tag].name },
                 event->mono_ns);
        break;
    }
}

/* --- devices ---------------------------------------------------------------------------------------------------------------- */

/* The device is now known to be lost as a whole, and its LINK alarm reports the failure: suppresses the unacknowledged BAD
   alarms that its tags raised before. */
static void carry_all(struct alarms *alarms, const struct alarm_device *device, struct instant now)
{
    for (size_t i = 0; i < alarms->count; i++) {
        const struct alarm *alarm = &alarms->list[i];
        bool seen = alarm->rule.acknowledges && !alarm->state.unacknowledged;
        if (alarm->kind == ALARM_BAD && alarm->state.active && !alarm->state.aside && !seen && carrier_of(alarms, alarm) == device)
            step(alarms, (int)i,
                 &(struct alarm_change){ .event = ALARM_CARRY, .utc_ns = now.utc_ns, .value = NAN, .who = "", .reason = device->name },
                 now.mono_ns);
    }
}

static void look_at_devices(struct alarms *alarms, struct instant now)
{
    for (size_t i = 0; i < alarms->devices->count; i++) {
        struct alarm_device *device = &alarms->devices->list[i];
        if (!device->changed || device->alarm < 0)
            continue;
        device->changed = false;
        put(alarms, device->alarm, device_is_lost(device) ? CONDITION_BEYOND : CONDITION_CLEAR, NAN, now);
        if (device_is_lost(device))
            carry_all(alarms, device, now);
    }
}

/* Returns true if a tag needs its own BAD alarm again, which was suppressed because the device's LINK alarm reported the
   failure: the device has been back for the tag's stale time, but the tag is still Bad. The device may answer with errors only,
   so possibly none of its tags is usable. */
static bool calls_by_itself(const struct alarms *alarms, const struct alarm *alarm, int64_t mono_ns)
{
    const struct alarm_device *device = &alarms->devices->list[alarms->devices->of_tag[alarm->tag]];
    double stale_s = fmin(alarms->plant->tags[alarm->tag].validity.stale_s, LONGEST_RETURN_S);
    return device->back_ns && (double)(mono_ns - device->back_ns) >= stale_s * 1e9;
}

static void call_those_left(struct alarms *alarms, struct instant now)
{
    for (size_t i = 0; i < alarms->count && alarms->carried > 0; i++) {
        const struct alarm *alarm = &alarms->list[i];
        if (alarm->state.aside & ALARM_ASIDE_CARRIED && calls_by_itself(alarms, alarm, now.mono_ns))
            step(alarms, (int)i, &(struct alarm_change){ .event = ALARM_CALL, .utc_ns = now.utc_ns, .value = NAN, .who = "", .reason = "" },
                 now.mono_ns);
    }
}

/* Returns what a tag's quality says about the tag's device. A tag that never becomes stale stays usable with its last value
   while the device is lost; for such a tag the quality "no communication, last usable value" counts as lost. */
static enum device_status status_of(const struct alarms *alarms, size_t tag, uint32_t quality)
{
    bool lost = quality == QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE && never_stale(alarms, tag);
    return lost ? DEVICE_GONE : device_status_of(quality);
}

/* Returns true if alarms ignore a sample for now. A derived tag's sample repeats the Bad quality of its inputs. Until the derived tag
   has had a sample of its own, such a sample does not count: the tag waits for its first reading (is_still_waiting()). */
static bool is_ignored(const struct alarms *alarms, const struct sample_event *event)
{
    if (event->quality == QUALITY_BAD_WAITING)
        return true;
    return alarms->devices->of_tag[event->tag] < 0 && !alarms->seen[event->tag].sampled && device_status_of(event->quality) == DEVICE_GONE;
}

/* evaluates the samples' devices before their tags, so that a device's LINK alarm can suppress the BAD alarms of the tags */
void alarms_put(struct alarms *alarms, const struct sample_event *event, size_t count)
{
    for (size_t i = 0; i < count; i++)
        devices_put(alarms->devices, event[i].tag, status_of(alarms, (size_t)event[i].tag, event[i].quality), event[i].mono_ns);
    if (count > 0)
        look_at_devices(alarms, (struct instant){ event[count - 1].mono_ns, event[count - 1].utc_ns });
    for (size_t i = 0; i < count; i++) {
        int tag = event[i].tag;
        struct last_sample *seen = &alarms->seen[tag];
        if (is_ignored(alarms, &event[i]))
            continue;
        seen->sampled = true;
        seen->recheck = false;
        seen->bad = quality_is_bad(event[i].quality);
        for (int k = alarms->first_feed[tag]; k < alarms->first_feed[tag + 1]; k++)
            put_sample(alarms, &alarms->feeds[k], &event[i]);
        seen->value = event[i].value;
    }
}

/* --- time ------------------------------------------------------------------------------------------------------------------- */

/* Returns true while a Bad quality of the tag does not count yet: the tag has had no reading since this daemon began to evaluate
   alarms or since a reload discarded its reading, and its stale time is not over. If its source cannot be read, it waits for at
   most LONGEST_RETURN_S: the tag of a source that reports once an hour has a stale time of hours. */
static bool is_still_waiting(struct alarms *alarms, size_t tag, uint32_t quality, int64_t mono_ns)
{
    struct last_sample *seen = &alarms->seen[tag];
    double stale_s = alarms->plant->tags[tag].validity.stale_s;
    if (!quality_is_bad(quality) || (seen->sampled && quality != QUALITY_BAD_WAITING)) {
        seen->waits_since_ns = 0;
        return false;
    }
    if (!seen->waits_since_ns)
        seen->waits_since_ns = mono_ns;
    if (stale_s >= PLANT_NEVER_STALE_S || quality != QUALITY_BAD_WAITING)
        stale_s = fmin(stale_s, LONGEST_RETURN_S);
    return (double)(mono_ns - seen->waits_since_ns) < stale_s * 1e9;
}

/* Returns true if no sample event need be created for the tag's current quality: no alarm depends on the tag, or its alarms
   have already seen that quality. */
static bool is_no_news(const struct alarms *alarms, size_t tag, uint32_t quality)
{
    const struct last_sample *seen = &alarms->seen[tag];
    bool bad = quality_is_bad(quality);
    int of = alarms->devices->of_tag[tag];
    bool counts = of >= 0 && alarms->devices->list[of].alarm >= 0;
    if (alarms->first_feed[tag] == alarms->first_feed[tag + 1] && !counts)
        return true;
    if (seen->recheck)
        return false;
    if (!seen->sampled)
        return !bad;
    return seen->bad == bad && (!counts || alarms->devices->statuses[tag] == status_of(alarms, tag, quality));
}

/* A reload has discarded the tag's reading, so its value is unknown until its next reading: the tag's alarms keep their states, and
   their running delays stop, as while the tag is Bad. */
static void suspend(struct alarms *alarms, size_t tag, int64_t mono_ns)
{
    for (int k = alarms->first_feed[tag]; k < alarms->first_feed[tag + 1]; k++) {
        int index = alarms->feeds[k].alarm;
        switch (alarms->feeds[k].role) {
        case FEED_VALUE:
        case FEED_BIT:
            set_held(alarms, index, true);
            condition_hold(&alarms->list[index].condition, mono_ns);
            break;
        case FEED_BADNESS: condition_hold(&alarms->list[index].condition, mono_ns); break;
        case FEED_ACKNOWLEDGED: alarms->list[index].acknowledgement_bad = true; break;
        case FEED_SUPPRESSES: break;
        }
    }
}

/* Creates sample events for tags that became stale after their last sample, that have waited too long for a first sample, or
   whose alarms a reload may have changed. Evaluates the alarms with these events. */
static void look_at_qualities(struct alarms *alarms, const struct snapshot *now)
{
    size_t count = 0;
    for (size_t i = 0; i < now->count; i++) {
        const struct reading *reading = &now->readings[i];
        if (is_still_waiting(alarms, i, reading->quality, now->taken_mono_ns)) {
            if (alarms->seen[i].recheck)
                suspend(alarms, i, now->taken_mono_ns);
            continue;
        }
        uint32_t quality = reading->quality == QUALITY_BAD_WAITING ? QUALITY_BAD_NO_COMMUNICATION : reading->quality;
        if (is_no_news(alarms, i, quality))
            continue;
        alarms->seen[i].sampled = true; /* the waiting time is over: is_ignored() must not drop the event */
        alarms->noticed[count++] =
            (struct sample_event){ (int)i, quality_is_bad(quality) ? NAN : reading->value, quality, now->taken_mono_ns, now->taken_utc_ns };
    }
    alarms_put(alarms, alarms->noticed, count);
}

static void end_shelf(struct alarms *alarms, int index, struct instant now)
{
    struct alarm *alarm = &alarms->list[index];
    alarm->until = (struct instant){ 0 };
    alarm->who[0] = alarm->reason[0] = 0;
    step(alarms, index,
         &(struct alarm_change){ .event = ALARM_UNSHELVE,
                                 .utc_ns = now.utc_ns,
                                 .value = NAN,
                                 .who = "",
                                 .reason = "the time for which the alarm was shelved is over" },
         now.mono_ns);
}

void alarms_tick(struct alarms *alarms, const struct snapshot *snapshot)
{
    struct instant now = { snapshot->taken_mono_ns, snapshot->taken_utc_ns };
    size_t kept = 0, count = alarms->timed_count;
    for (size_t i = 0; i < count; i++) {
        int index = alarms->timed[i];
        struct alarm *alarm = &alarms->list[index];
        advance(alarms, index, now);
        bool is_over = now.mono_ns >= alarm->until.mono_ns || (alarm->until_restored && now.utc_ns >= alarm->until.utc_ns);
        if (alarm->until.mono_ns && is_over)
            end_shelf(alarms, index, now);
        alarm->timed = condition_is_timed(&alarm->condition) || alarm->until.mono_ns;
        if (alarm->timed)
            alarms->timed[kept++] = index;
    }
    alarms->timed_count = kept;
    look_at_qualities(alarms, snapshot);
    call_those_left(alarms, now);
}

/* --- operators' actions --------------------------------------------------------------------------------------------------------- */

static enum refusal_code refusal_of(enum alarm_event event)
{
    switch (event) {
    case ALARM_ACKNOWLEDGE: return REFUSAL_QUIET;
    case ALARM_RESET: return REFUSAL_LATCHED;
    default: return REFUSAL_OTHERWISE;
    }
}

enum refusal_code alarms_act(struct alarms *alarms, int index, const struct alarm_act *act, struct instant now)
{
    struct alarm *alarm = &alarms->list[index];
    bool shelves = act->event == ALARM_SHELVE;
    if (alarms->plant->alarms != ALARMS_LOCAL)
        return REFUSAL_ELSEWHERE;
    if (shelves && (act->for_ns <= 0 || act->for_ns > ALARM_LONGEST_SHELF_NS))
        return REFUSAL_SHELF;
    char who[ALARM_NAME_BYTES], reason[ALARM_REASON_BYTES];
    memcpy(who, alarm->who, sizeof(who));
    memcpy(reason, alarm->reason, sizeof(reason));
    struct instant until = alarm->until;
    alarm->until = shelves                        ? (struct instant){ now.mono_ns + act->for_ns, now.utc_ns + act->for_ns }
                   : act->event == ALARM_UNSHELVE ? (struct instant){ 0 }
                                                  : until;
    strncpy(alarm->who, act->who, sizeof(alarm->who) - 1);
    strncpy(alarm->reason, act->reason, sizeof(alarm->reason) - 1);
    enum alarm_outcome outcome =
        step(alarms, index,
             &(struct alarm_change){ .event = act->event, .utc_ns = now.utc_ns, .value = NAN, .who = act->who, .reason = act->reason },
             now.mono_ns);
    if (outcome == ALARM_CHANGED) {
        if (shelves)
            alarm->until_restored = false;
        alarms_watch(alarms, index);
        return REFUSAL_NONE;
    }
    memcpy(alarm->who, who, sizeof(who));
    memcpy(alarm->reason, reason, sizeof(reason));
    alarm->until = until;
    return outcome == ALARM_AS_IT_WAS ? REFUSAL_OTHERWISE : refusal_of(act->event);
}

/* --- queries -------------------------------------------------------------------------------------------------------------------- */

const struct alarm *alarms_at(const struct alarms *alarms, int index)
{
    return &alarms->list[index];
}

int alarms_find(const struct alarms *alarms, int tag, enum alarm_kind kind)
{
    for (int i = alarms->first_alarm[tag]; i < alarms->first_alarm[tag + 1]; i++)
        if (alarms->list[alarms->by_tag[i]].kind == kind)
            return alarms->by_tag[i];
    return -1;
}

int alarms_find_named(const struct alarms *alarms, const char *name, enum alarm_kind kind)
{
    if (kind == ALARM_LINK) {
        int of = devices_find(alarms->devices, name);
        return of < 0 ? -1 : alarms->devices->list[of].alarm;
    }
    int tag = plant_find_tag(alarms->plant, name);
    return tag < 0 ? -1 : alarms_find(alarms, tag, kind);
}

uint64_t alarms_number(const struct alarms *alarms)
{
    return alarms->number;
}

int alarms_newest(const struct alarms *alarms)
{
    return alarms->newest;
}
