/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stores the newest reading of every tag, and computes the reading's current quality. */
#include "value/store.h"

#include <assert.h>
#include <math.h>
#include <pthread.h>
#include <string.h>

#include "base/mem.h"
#include "plant/plant_diff.h"
#include "value/quality.h"

struct held {
    double value;     /* last usable value */
    uint32_t quality; /* quality that the tag's last sample states */
    /* has_value: `value` is set; lost: the source could not read the tag since the tag's last sample */
    bool has_value, lost;
    /* true: the tag is lost, and its last value must not be used although it is recent (store_tags_dead()) */
    bool dead;
    /* true: the reading comes from the plant before a reload or from a core, or is undated (store_write_undated()). The tag's next
       sample replaces it, however old that sample is. */
    bool replaceable;
    int64_t sampled_mono_ns;                   /* monotonic time of the tag's last sample, whether Good or Bad */
    /* arrival time of the tag's last usable value: received_mono_ns: on the monotonic clock; received_utc_ns: in UTC */
    int64_t received_mono_ns, received_utc_ns;
    int64_t changed_mono_ns;                   /* monotonic time at which a usable value last differed from the one before */
    int64_t stale_ns, flatline_ns;
    /* A quality tag decides the quality of a list of other tags. first_vouched: index of the first tag whose quality this tag
       decides. next_vouched: index of the next tag in the list to which this tag belongs. -1: none. */
    int first_vouched, next_vouched;
    uint32_t shown_quality; /* quality that the tag had when `changes` was last incremented */
    uint32_t changes;
    uint8_t alarm, alarm_status;
};

struct source_link {
    bool up;
    int64_t changed_mono_ns;
};

struct store {
    const struct plant *plant;
    pthread_mutex_t lock;
    /* --- below: under lock */
    struct held *tags;
    struct source_link *links;
    struct {
        store_listener *hear;
        void *arg;
        bool all; /* true: also called by store_tell_aged() */
    } listeners[STORE_LISTENERS];
    struct {
        void (*changed)(void *arg); /* callback: a reading, an alarm or the connection to a source has changed; NULL: not wanted */
        void *arg;
        bool told; /* true: changed() has been called since the last store_take(), so it is not called again */
    } watch;
    int64_t utc_ahead_ns; /* difference in nanoseconds between UTC and the monotonic clock, when the last sample arrived */
    bool has_utc;         /* a sample has arrived */
};

static int64_t ns_of(double s)
{
    return s < 9e9 ? (int64_t)(s * 1e9) : INT64_MAX;
}

static void set_limits(struct held *held, const struct tag_validity *validity)
{
    held->stale_ns = ns_of(validity->stale_s);
    held->flatline_ns = validity->flatline_s > 0 ? ns_of(validity->flatline_s) : INT64_MAX;
}

static void add_vouched(struct store *store, int tag)
{
    const struct plant_quality_tag *by = &store->plant->tags[tag].validity.quality;
    if (by->mask == 0)
        return;
    store->tags[tag].next_vouched = store->tags[by->tag].first_vouched;
    store->tags[by->tag].first_vouched = tag;
}

struct store *store_create(const struct plant *plant)
{
    struct store *store = mem_new(sizeof(*store));
    store->plant = plant;
    store->tags = mem_array(plant->tag_count, sizeof(*store->tags));
    store->links = mem_array(plant->source_count, sizeof(*store->links));
    for (size_t i = 0; i < plant->tag_count; i++) {
        store->tags[i] = (struct held){
            .quality = QUALITY_BAD_WAITING,
            .shown_quality = QUALITY_BAD_WAITING,
            .sampled_mono_ns = INT64_MIN,
            .first_vouched = -1,
            .next_vouched = -1,
        };
        set_limits(&store->tags[i], &plant->tags[i].validity);
    }
    for (size_t i = 0; i < plant->tag_count; i++)
        add_vouched(store, (int)i);
    for (size_t i = 0; i < plant->source_count; i++)
        store->links[i].changed_mono_ns = INT64_MIN;
    pthread_mutex_init(&store->lock, NULL);
    return store;
}

void store_destroy(struct store **store)
{
    if (!*store)
        return;
    pthread_mutex_destroy(&(*store)->lock);
    mem_free((*store)->tags);
    mem_free((*store)->links);
    mem_free(*store);
    *store = NULL;
}

static int find_source(const struct plant *plant, const char *id)
{
    int i = (int)plant->source_count - 1;
    while (i >= 0 && strcmp(plant->sources[i].id, id) != 0)
        i--;
    return i;
}

static void adopt_tag(struct store *store, const struct store *before, size_t tag)
{
    struct held *to = &store->tags[tag];
    const struct held own = *to;
    *to = before->tags[plant_find_tag(before->plant, store->plant->tags[tag].name)];
    to->replaceable = true;
    /* does not take over the alarm of the old reading: limits may have changed, and the alarm service sets the alarm again */
    to->alarm = own.alarm;
    to->alarm_status = own.alarm_status;
    to->stale_ns = own.stale_ns;
    to->flatline_ns = own.flatline_ns;
    to->first_vouched = own.first_vouched;
    to->next_vouched = own.next_vouched;
}

void store_adopt(struct store *store, struct store *before)
{
    const struct plant *plant = store->plant;
    bool *kept = mem_array(plant->tag_count, sizeof(*kept));
    plant_kept_signals(before->plant, plant, kept);
    pthread_mutex_lock(&before->lock);
    pthread_mutex_lock(&store->lock);
    for (size_t i = 0; i < plant->tag_count; i++)
        if (kept[i])
            adopt_tag(store, before, i);
    for (size_t i = 0; i < before->plant->source_count; i++) {
        int source = find_source(store->plant, before->plant->sources[i].id);
        if (source >= 0)
            store->links[source] = before->links[i];
    }
    store->utc_ahead_ns = before->utc_ahead_ns;
    store->has_utc = before->has_utc;
    pthread_mutex_unlock(&store->lock);
    pthread_mutex_unlock(&before->lock);
    mem_free(kept);
}

static void listen(struct store *store, store_listener *listener, void *arg, bool all)
{
    int i = 0;
    pthread_mutex_lock(&store->lock);
    while (i < STORE_LISTENERS && store->listeners[i].hear)
        i++;
    assert(i < STORE_LISTENERS);
    store->listeners[i].hear = listener;
    store->listeners[i].arg = arg;
    store->listeners[i].all = all;
    pthread_mutex_unlock(&store->lock);
}

void store_listen(struct store *store, store_listener *listener, void *arg)
{
    listen(store, listener, arg, false);
}

void store_listen_all(struct store *store, store_listener *listener, void *arg)
{
    listen(store, listener, arg, true);
}

bool store_tell_aged(struct store *store, const struct sample_event *event)
{
    pthread_mutex_lock(&store->lock);
    bool newest = store->tags[event->tag].sampled_mono_ns <= event->mono_ns;
    for (int i = 0; i < STORE_LISTENERS && newest; i++)
        if (store->listeners[i].hear && store->listeners[i].all)
            store->listeners[i].hear(store->listeners[i].arg, event);
    pthread_mutex_unlock(&store->lock);
    return newest;
}

void store_unlisten(struct store *store, store_listener *listener, void *arg)
{
    pthread_mutex_lock(&store->lock);
    for (int i = 0; i < STORE_LISTENERS; i++)
        if (store->listeners[i].hear == listener && store->listeners[i].arg == arg)
            store->listeners[i].hear = NULL;
    pthread_mutex_unlock(&store->lock);
}

void store_watch(struct store *store, void (*changed)(void *arg), void *arg)
{
    pthread_mutex_lock(&store->lock);
    store->watch.changed = changed;
    store->watch.arg = arg;
    store->watch.told = false;
    pthread_mutex_unlock(&store->lock);
}

static void tell_watch(struct store *store)
{
    if (store->watch.told || !store->watch.changed)
        return;
    store->watch.told = true;
    store->watch.changed(store->watch.arg);
}

static void tell(struct store *store, size_t tag, uint32_t quality, int64_t mono_ns, int64_t utc_ns)
{
    const struct sample_event event = { (int)tag, quality_is_bad(quality) ? NAN : store->tags[tag].value, quality, mono_ns, utc_ns };
    for (int i = 0; i < STORE_LISTENERS; i++)
        if (store->listeners[i].hear)
            store->listeners[i].hear(store->listeners[i].arg, &event);
}

/* Returns the quality that follows from the tag's last sample and from the age of its last value. */
static uint32_t own_quality(const struct held *held, int64_t now_mono_ns)
{
    bool stale = held->has_value && now_mono_ns - held->received_mono_ns >= held->stale_ns;
    if (held->lost && !held->has_value)
        return QUALITY_BAD_NO_COMMUNICATION;
    if (held->lost && (stale || held->dead || quality_is_bad(held->quality)))
        return QUALITY_BAD_COMMUNICATION_ERROR;
    if (quality_is_bad(held->quality))
        return held->quality;
    if (stale)
        return QUALITY_BAD_COMMUNICATION_ERROR;
    if (held->lost)
        return QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE;
    bool flat = held->received_mono_ns - held->changed_mono_ns >= held->flatline_ns;
    return flat && quality_is_good(held->quality) ? QUALITY_UNCERTAIN_SENSOR_NOT_ACCURATE : held->quality;
}

/* Returns Bad if the source's heartbeat tag shows that the controller behind the source has stopped; otherwise Good. */
static uint32_t heartbeat_quality(const struct store *store, size_t tag, int64_t now_mono_ns)
{
    int index = store->plant->tags[tag].source;
    const struct plant_source *source = index < 0 ? NULL : &store->plant->sources[index];
    if (!source || !(source->heartbeat_s > 0))
        return QUALITY_GOOD;
    const struct held *heart = &store->tags[source->heartbeat_tag];
    if (!heart->has_value)
        return heart->quality;
    return now_mono_ns - heart->changed_mono_ns >= ns_of(source->heartbeat_s) ? QUALITY_BAD_DEVICE_FAILURE : QUALITY_GOOD;
}

/* Returns the quality that the tag's quality tag (PLANT.md) decides; Good if it has none. */
static uint32_t vouched_quality(const struct store *store, size_t tag, int64_t now_mono_ns)
{
    const struct plant_quality_tag *by = &store->plant->tags[tag].validity.quality;
    if (by->mask == 0)
        return QUALITY_GOOD;
    const struct held *word = &store->tags[by->tag];
    bool readable =
        quality_is_good(own_quality(word, now_mono_ns)) && quality_is_good(heartbeat_quality(store, (size_t)by->tag, now_mono_ns));
    /* the quality tag's value is a double with 53 bits, so a larger number lacks its lowest bits, which the mask may select */
    if (!readable || !(fabs(word->value) <= 0x1p53))
        return QUALITY_UNCERTAIN;
    bool good = (((uint64_t)(int64_t)word->value & by->mask) == by->want) != by->negate;
    return good ? QUALITY_GOOD : QUALITY_BAD_SENSOR_FAILURE;
}

/* Returns the worst quality of three: the tag's own sample, the heartbeat of its source, and its quality tag. */
static uint32_t quality_now(const struct store *store, size_t tag, int64_t now_mono_ns)
{
    uint32_t quality = own_quality(&store->tags[tag], now_mono_ns);
    uint32_t others[] = { heartbeat_quality(store, tag, now_mono_ns), vouched_quality(store, tag, now_mono_ns) };
    for (int i = 0; i < 2; i++)
        if (quality_is_worse(others[i], quality))
            quality = others[i];
    return quality;
}

/* If the tag's value or quality changed, increments its change counter and returns true. */
static bool count_change(struct store *store, size_t tag, bool value_changed, int64_t now_mono_ns)
{
    struct held *held = &store->tags[tag];
    uint32_t quality = quality_now(store, tag, now_mono_ns);
    bool changed = value_changed || quality != held->shown_quality;
    held->changes += changed;
    held->shown_quality = quality;
    return changed;
}

static bool hold(struct store *store, const struct sample *sample, bool is_undated, int64_t now_mono_ns, int64_t now_utc_ns)
{
    struct held *held = &store->tags[sample->tag];
    bool bad = quality_is_bad(sample->quality), finite = isfinite(sample->value), value_changed = false;
    if (held->replaceable) {
        /* a reading from a core had no limits of its own (mirror()) */
        set_limits(held, &store->plant->tags[sample->tag].validity);
    } else if (now_mono_ns < held->sampled_mono_ns) {
        /* Ignores a sample older than the tag's last sample, with one exception: the tag was marked dead (its source was lost),
           and the sample is not older in UTC than the tag's last value, if any. Then the sample shows that the source is back. */
        if (!held->dead || now_utc_ns < held->received_utc_ns)
            return false;
        now_mono_ns = held->sampled_mono_ns;
    }
    held->replaceable = is_undated;
    held->quality = bad || finite ? sample->quality : QUALITY_BAD_SENSOR_FAILURE;
    held->sampled_mono_ns = now_mono_ns;
    held->lost = held->dead = false;
    if (!bad && finite) {
        value_changed = !held->has_value || held->value != sample->value;
        held->value = sample->value;
        if (value_changed)
            held->changed_mono_ns = now_mono_ns;
        held->has_value = true;
        held->received_mono_ns = now_mono_ns;
        held->received_utc_ns = now_utc_ns;
    }
    if (count_change(store, (size_t)sample->tag, value_changed, now_mono_ns))
        tell_watch(store);
    return true;
}

/* Reports changed qualities of all tags whose quality this tag decides. */
static void tell_vouched(struct store *store, int tag, int64_t now_mono_ns, int64_t now_utc_ns)
{
    for (int i = store->tags[tag].first_vouched; i >= 0; i = store->tags[i].next_vouched) {
        if (!count_change(store, (size_t)i, false, now_mono_ns))
            continue;
        tell_watch(store);
        tell(store, (size_t)i, store->tags[i].shown_quality, now_mono_ns, now_utc_ns);
    }
}

static void write_all(struct store *store, const struct sample *samples, size_t count, bool are_undated, int64_t now_mono_ns,
                      int64_t now_utc_ns)
{
    pthread_mutex_lock(&store->lock);
    store->utc_ahead_ns = now_utc_ns - now_mono_ns;
    store->has_utc = true;
    for (size_t i = 0; i < count; i++)
        if (hold(store, &samples[i], are_undated, now_mono_ns, now_utc_ns)) {
            tell(store, (size_t)samples[i].tag, store->tags[samples[i].tag].shown_quality, now_mono_ns, now_utc_ns);
            tell_vouched(store, samples[i].tag, now_mono_ns, now_utc_ns);
        }
    pthread_mutex_unlock(&store->lock);
}

void store_write(struct store *store, const struct sample *samples, size_t count, int64_t now_mono_ns, int64_t now_utc_ns)
{
    write_all(store, samples, count, false, now_mono_ns, now_utc_ns);
}

void store_write_undated(struct store *store, const struct sample *samples, size_t count, int64_t now_mono_ns, int64_t now_utc_ns)
{
    write_all(store, samples, count, true, now_mono_ns, now_utc_ns);
}

static void mirror(struct store *store, const struct mirrored *reading, int64_t now_mono_ns)
{
    struct held *held = &store->tags[reading->tag];
    bool value_changed = reading->has_value && (!held->has_value || held->value != reading->value);
    held->quality = reading->quality;
    held->has_value = reading->has_value;
    held->value = reading->has_value ? reading->value : 0;
    held->received_mono_ns = reading->received_mono_ns;
    held->received_utc_ns = reading->received_utc_ns;
    held->sampled_mono_ns = held->changed_mono_ns = now_mono_ns;
    held->lost = held->dead = false;
    held->replaceable = true;
    /* a reading that comes from a core (the daemon that reads the devices) never becomes stale in this store: the core decides its
       quality. If this daemon takes over from that core, the tag's first sample sets the limits again (hold()). */
    held->stale_ns = held->flatline_ns = INT64_MAX;
    if (count_change(store, (size_t)reading->tag, value_changed, now_mono_ns))
        tell_watch(store);
}

void store_mirror(struct store *store, const struct mirrored *readings, size_t count, int64_t now_mono_ns)
{
    pthread_mutex_lock(&store->lock);
    for (size_t i = 0; i < count; i++)
        mirror(store, &readings[i], now_mono_ns);
    pthread_mutex_unlock(&store->lock);
}

/* Tells the listeners about a quality that changed without a sample. */
static void tell_change(struct store *store, size_t tag, int64_t now_mono_ns)
{
    if (count_change(store, tag, false, now_mono_ns) && store->has_utc)
        tell(store, tag, store->tags[tag].shown_quality, now_mono_ns, now_mono_ns + store->utc_ahead_ns);
}

static void lose(struct store *store, size_t tag, bool dead, int64_t now_mono_ns)
{
    struct held *held = &store->tags[tag];
    if (now_mono_ns < held->sampled_mono_ns)
        return;
    /* calls the watch callback even if the tag's own quality stays the same, because the quality of tags that depend on it may change */
    if (!held->lost || (dead && !held->dead))
        tell_watch(store);
    held->lost = true;
    held->dead |= dead;
    tell_change(store, tag, now_mono_ns);
}

void store_tags_lost(struct store *store, const int *tags, size_t count, int64_t now_mono_ns)
{
    pthread_mutex_lock(&store->lock);
    for (size_t i = 0; i < count; i++)
        lose(store, (size_t)tags[i], false, now_mono_ns);
    pthread_mutex_unlock(&store->lock);
}

void store_tags_dead(struct store *store, const int *tags, size_t count, int64_t now_mono_ns)
{
    pthread_mutex_lock(&store->lock);
    for (size_t i = 0; i < count; i++)
        lose(store, (size_t)tags[i], true, now_mono_ns);
    pthread_mutex_unlock(&store->lock);
}

/* Makes a Good reading Uncertain. An Uncertain tag still counts as usable for its device (device_status_of()), so the device's LINK
   alarm is not raised. */
static void doubt(struct store *store, size_t tag, int64_t now_mono_ns)
{
    struct held *held = &store->tags[tag];
    if (now_mono_ns < held->sampled_mono_ns || !quality_is_good(held->quality))
        return;
    held->quality = QUALITY_UNCERTAIN_LAST_USABLE;
    tell_watch(store); /* also if the tag's own quality stays the same, for the same reason as in lose() */
    tell_change(store, tag, now_mono_ns);
}

void store_values_missed(struct store *store, const int *tags, size_t count, bool dead, int64_t now_mono_ns)
{
    pthread_mutex_lock(&store->lock);
    for (size_t i = 0; i < count; i++)
        if (store->tags[tags[i]].has_value && dead)
            lose(store, (size_t)tags[i], true, now_mono_ns);
        else if (store->tags[tags[i]].has_value)
            doubt(store, (size_t)tags[i], now_mono_ns);
    pthread_mutex_unlock(&store->lock);
}

static void set_link(struct store *store, int source, bool up, int64_t now_mono_ns)
{
    struct source_link *link = &store->links[source];
    if (now_mono_ns < link->changed_mono_ns)
        return;
    if (link->up != up)
        tell_watch(store);
    link->up = up;
    link->changed_mono_ns = now_mono_ns;
}

void store_link_lost(struct store *store, int source, int64_t now_mono_ns)
{
    pthread_mutex_lock(&store->lock);
    set_link(store, source, false, now_mono_ns);
    for (size_t i = 0; i < store->plant->tag_count; i++)
        if (store->plant->tags[i].source == source)
            lose(store, i, false, now_mono_ns);
    pthread_mutex_unlock(&store->lock);
}

void store_link_down(struct store *store, int source, int64_t now_mono_ns)
{
    pthread_mutex_lock(&store->lock);
    set_link(store, source, false, now_mono_ns);
    pthread_mutex_unlock(&store->lock);
}

void store_link_up(struct store *store, int source, int64_t now_mono_ns)
{
    pthread_mutex_lock(&store->lock);
    set_link(store, source, true, now_mono_ns);
    pthread_mutex_unlock(&store->lock);
}

void store_set_alarm(struct store *store, int tag, int alarm, int status)
{
    struct held *held = &store->tags[tag];
    pthread_mutex_lock(&store->lock);
    if (held->alarm != alarm || held->alarm_status != status) {
        held->changes++;
        tell_watch(store);
    }
    held->alarm = (uint8_t)alarm;
    held->alarm_status = (uint8_t)status;
    pthread_mutex_unlock(&store->lock);
}

bool store_link_is_up(const struct store *store, int source)
{
    pthread_mutex_t *lock = (pthread_mutex_t *)&store->lock;
    pthread_mutex_lock(lock);
    bool up = store->links[source].up;
    pthread_mutex_unlock(lock);
    return up;
}

bool store_has_value(struct store *store, int tag)
{
    pthread_mutex_lock(&store->lock);
    bool has_value = store->tags[tag].has_value;
    pthread_mutex_unlock(&store->lock);
    return has_value;
}

static void read_held(struct store *store, size_t tag, int64_t now_mono_ns, struct reading *out)
{
    const struct held *held = &store->tags[tag];
    int64_t age_ns = now_mono_ns - held->received_mono_ns;
    count_change(store, tag, false, now_mono_ns);
    *out = (struct reading){
        .value = held->value,
        .quality = held->shown_quality,
        .changes = held->changes,
        .alarm = held->alarm,
        .alarm_status = held->alarm_status,
        .received_utc_ns = held->received_utc_ns,
        .age_ns = held->has_value ? (age_ns > 0 ? age_ns : 0) : INT64_MAX,
    };
}

static void read_all(struct store *store, int64_t now_mono_ns, int64_t now_utc_ns, struct snapshot *into)
{
    for (size_t i = 0; i < store->plant->tag_count; i++)
        read_held(store, i, now_mono_ns, &into->readings[i]);
    into->taken_mono_ns = now_mono_ns;
    into->taken_utc_ns = now_utc_ns;
}

void store_snapshot(struct store *store, int64_t now_mono_ns, int64_t now_utc_ns, struct snapshot *into)
{
    pthread_mutex_lock(&store->lock);
    read_all(store, now_mono_ns, now_utc_ns, into);
    pthread_mutex_unlock(&store->lock);
}

/* Returns the earlier of next_ns and since_ns + after_ns, but ignores since_ns + after_ns unless it is in the future. */
static int64_t sooner(int64_t next_ns, int64_t since_ns, int64_t after_ns, int64_t now_mono_ns)
{
    bool comes = after_ns < INT64_MAX && since_ns + after_ns > now_mono_ns;
    return comes && since_ns + after_ns < next_ns ? since_ns + after_ns : next_ns;
}

/* Returns the monotonic time when the next reading becomes stale, or the next heartbeat counts as stopped; INT64_MAX: never. */
static int64_t next_change_ns(const struct store *store, int64_t now_mono_ns)
{
    int64_t next_ns = INT64_MAX;
    for (size_t i = 0; i < store->plant->tag_count; i++) {
        const struct held *held = &store->tags[i];
        if (held->has_value && !quality_is_bad(held->quality))
            next_ns = sooner(next_ns, held->received_mono_ns, held->stale_ns, now_mono_ns);
    }
    for (size_t i = 0; i < store->plant->source_count; i++) {
        const struct plant_source *source = &store->plant->sources[i];
        if (source->heartbeat_s > 0 && store->tags[source->heartbeat_tag].has_value)
            next_ns = sooner(next_ns, store->tags[source->heartbeat_tag].changed_mono_ns, ns_of(source->heartbeat_s), now_mono_ns);
    }
    return next_ns;
}

/* Lists the monotonic times at which time alone changes a tag's quality: its reading becomes stale, the heartbeat of its source
   counts as stopped; INT64_MAX: never. The time at which a value has been unchanged for too long is not listed, because that
   takes effect only with the tag's next sample. */
static void list_ageing(const struct store *store, size_t tag, int64_t at_ns[2])
{
    const struct held *held = &store->tags[tag];
    int index = store->plant->tags[tag].source;
    const struct plant_source *source = index < 0 ? NULL : &store->plant->sources[index];
    const struct held *heart = source && source->heartbeat_s > 0 ? &store->tags[source->heartbeat_tag] : NULL;
    bool beats = heart && heart->has_value;
    at_ns[0] = held->has_value && held->stale_ns < INT64_MAX ? held->received_mono_ns + held->stale_ns : INT64_MAX;
    at_ns[1] = beats ? heart->changed_mono_ns + ns_of(source->heartbeat_s) : INT64_MAX;
}

int64_t store_aged_ns(struct store *store, int tag, int64_t now_mono_ns)
{
    int64_t at_ns[4], found_ns = now_mono_ns;
    pthread_mutex_lock(&store->lock);
    const struct plant_quality_tag *by = &store->plant->tags[tag].validity.quality;
    list_ageing(store, (size_t)tag, at_ns);
    list_ageing(store, by->mask != 0 ? (size_t)by->tag : (size_t)tag, at_ns + 2);
    uint32_t quality = quality_now(store, (size_t)tag, now_mono_ns);
    for (int i = 0; i < 4; i++)
        if (at_ns[i] > store->tags[tag].sampled_mono_ns && at_ns[i] < found_ns && quality_now(store, (size_t)tag, at_ns[i]) == quality)
            found_ns = at_ns[i];
    pthread_mutex_unlock(&store->lock);
    return found_ns;
}

int64_t store_take(struct store *store, int64_t now_mono_ns, int64_t now_utc_ns, struct snapshot *into)
{
    pthread_mutex_lock(&store->lock);
    read_all(store, now_mono_ns, now_utc_ns, into);
    store->watch.told = false;
    int64_t next_ns = next_change_ns(store, now_mono_ns);
    pthread_mutex_unlock(&store->lock);
    return next_ns;
}
