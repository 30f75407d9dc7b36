/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The store holds the newest sample of every tag. Sources write samples, any thread takes snapshots.
   The quality of a reading is the worst of: the sample's quality; the quality that follows from its age; Uncertain_SensorNotAccurate
   once the value has not changed for flatline_s; the quality that its quality tag gives; Bad_DeviceFailure once the heartbeat of its
   source has stopped. */
#ifndef VALUE_STORE_H
#define VALUE_STORE_H
#include <stdbool.h>
#include <stdint.h>

#include "plant/plant.h"
#include "value/snapshot.h"

struct store;

/* One value of one tag, as a source writes it. */
struct sample {
    int tag;      /* index in plant->tags */
    double value; /* value in engineering units; ignored while quality is Bad. NaN or infinity becomes Bad_SensorFailure */
    uint32_t quality;
};

/* Argument of listeners, called for every sample and every lost link, in order and under the store's lock: a listener copies the event
   and returns. A link lost before the very first sample makes no event, since the UTC time is not known yet; snapshots show it. */
struct sample_event {
    int tag;
    double value;
    uint32_t quality;
    int64_t mono_ns, utc_ns;
};
typedef void store_listener(void *arg, const struct sample_event *event);
enum { STORE_LISTENERS = 6 };

struct store *store_create(const struct plant *plant); /* Creates a store; `plant` must outlive it. */
void store_destroy(struct store **store);
/* Copies readings and link states from another store, for tags and sources of the same name. Call it before any listener is added. */
void store_adopt(struct store *store, struct store *before);
/* Adds a listener; at most STORE_LISTENERS. */
void store_listen(struct store *store, store_listener *listener, void *arg);
/* Removes a listener; the store no longer calls it once this function has returned. */
void store_unlisten(struct store *store, store_listener *listener, void *arg);
/* Sets the callback for changes of readings, alarms or links. The writing thread calls it under the store's lock, once, and not again
   before store_take(). It is not called when age alone makes a reading stale: store_take() returns when that will be. NULL removes the
   callback, which is not called any more once this function has returned. */
void store_watch(struct store *store, void (*changed)(void *arg), void *arg);
/* Writes samples that arrived at the given time. For a failed read call store_link_lost() instead. */
void store_write(struct store *store, const struct sample *samples, size_t count, int64_t now_mono_ns, int64_t now_utc_ns);
/* A reading as the store of another daemon shows it; a renderer receives it from its core. */
struct mirrored {
    int tag;
    uint32_t quality; /* quality shown by the core, staleness included */
    double value;     /* last usable value, if has_value */
    bool has_value;
    int64_t received_mono_ns, received_utc_ns; /* arrival time of that value; mono: on this machine's monotonic clock */
};
/* Writes readings of a core in place of samples: their quality is the core's and does not change with their age here. Listeners are not
   called. store_link_lost() and its variants apply to such readings too. */
void store_mirror(struct store *store, const struct mirrored *readings, size_t count, int64_t now_mono_ns);
/* Records that a source cannot be read from now on. Its tags keep their last values: Uncertain_NoCommunicationLastUsableValue until
   stale_s after their arrival, then Bad_CommunicationError. Tags that never had a value are Bad_NoCommunication. */
void store_link_lost(struct store *store, int source, int64_t now_mono_ns);
/* Does the same as store_link_lost() for some tags only: one unit behind a gateway fails while others still answer. */
void store_tags_lost(struct store *store, const int *tags, size_t count, int64_t now_mono_ns);
/* Makes some tags Bad_CommunicationError at once, whatever the age of their last values: the last values may not be used any more. */
void store_tags_dead(struct store *store, const int *tags, size_t count, int64_t now_mono_ns);
/* Records that a source can be read again. Each of its tags becomes usable with its next sample. */
void store_link_up(struct store *store, int source, int64_t now_mono_ns);
/* Records that a source is not connected, without changing its tags. For renderers, which receive each tag's state from the core. */
void store_link_down(struct store *store, int source, int64_t now_mono_ns);
/* Sets the alarm of a tag's readings from now on (enum alarm_kind) and its state (enum alarm_status). */
void store_set_alarm(struct store *store, int tag, int alarm, int status);
bool store_link_is_up(const struct store *store, int source);
/* Copies all readings, with their qualities as of now, into a snapshot that was made for the same plant. */
void store_snapshot(struct store *store, int64_t now_mono_ns, int64_t now_utc_ns, struct snapshot *into);
/* Does the same as store_snapshot() for the user of store_watch(), whose callback then reports changes after this call. Returns the
   monotonic time at which the next quality changes only because time passes; INT64_MAX: never. */
int64_t store_take(struct store *store, int64_t now_mono_ns, int64_t now_utc_ns, struct snapshot *into);

#endif
