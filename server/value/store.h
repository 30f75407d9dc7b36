/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The store holds the newest sample of every tag. Sources write, anyone takes snapshots. Thread: any.
   The quality of a reading is the worst of: that of the sample; that which follows from its age; Uncertain_SensorNotAccurate once the value
   has not changed for flatline_s; that of its quality tag; Bad_DeviceFailure once the heartbeat of its source has stopped. */
#ifndef VALUE_STORE_H
#define VALUE_STORE_H
#include <stdbool.h>
#include <stdint.h>

#include "plant/plant.h"
#include "value/snapshot.h"

struct store;

/* One value of one tag, as a source writes it. */
struct sample {
    int tag;          /* index in plant->tags */
    double value;     /* engineering units; not used while quality is Bad. NaN or infinite becomes Bad_SensorFailure */
    uint32_t quality;
};

/* What listeners are called with, for every sample and every lost link, in order and under the store's lock: a listener copies the event
   and returns. A link that is lost before the first sample of all makes no event, since the UTC time is not known; snapshots show it. */
struct sample_event {
    int tag;
    double value;
    uint32_t quality;
    int64_t mono_ns, utc_ns;
};
typedef void store_listener(void *arg, const struct sample_event *event);
enum { STORE_LISTENERS = 6 };

struct store *store_create(const struct plant *plant); /* plant must outlive it */
void store_destroy(struct store **store);
/* Copies readings and link states from another store, for tags and sources of the same name. To be called before anybody listens. */
void store_adopt(struct store *store, struct store *before);
/* Adds a listener; at most STORE_LISTENERS. */
void store_listen(struct store *store, store_listener *listener, void *arg);
/* Removes a listener; it is not called any more once this has returned. */
void store_unlisten(struct store *store, store_listener *listener, void *arg);
/* Has `changed` called when readings, alarms or links change: by the thread that writes, under the store's lock; once, and not again before
   store_take. It is not called when age alone makes a reading stale: store_take returns when that will be. NULL: nobody is told any more
   once this has returned. */
void store_watch(struct store *store, void (*changed)(void *arg), void *arg);
/* Writes samples that arrived at the given time. A failed read is no sample: see store_link_lost(). */
void store_write(struct store *store, const struct sample *samples, size_t count, int64_t now_mono_ns, int64_t now_utc_ns);
/* A reading as another daemon's store shows it: a renderer has it from its core. */
struct mirrored {
    int tag;
    uint32_t quality;          /* as shown there, staleness and all */
    double value;              /* the last usable one, if there was one */
    bool has_value;
    int64_t received_mono_ns, received_utc_ns; /* when that came in; monotonic: on this machine's clock */
};
/* Takes readings as they are shown elsewhere, in place of samples: their quality is what it is there, and does not follow from their age.
   Listeners do not hear of it. store_link_lost and its like hold for them, too. */
void store_mirror(struct store *store, const struct mirrored *readings, size_t count, int64_t now_mono_ns);
/* Records that a source cannot be read from now on. Its tags keep their last values: Uncertain_NoCommunicationLastUsableValue until
   stale_s after they arrived, then Bad_CommunicationError. Tags that never had a value are Bad_NoCommunication. */
void store_link_lost(struct store *store, int source, int64_t now_mono_ns);
/* The same for some tags only: one unit behind a gateway fails while others still answer. */
void store_tags_lost(struct store *store, const int *tags, size_t count, int64_t now_mono_ns);
/* The same for some tags whose last values may not be used any more, whatever their age: they are Bad_CommunicationError at once. */
void store_tags_dead(struct store *store, const int *tags, size_t count, int64_t now_mono_ns);
/* Records that a source can be read again. Its tags become usable one by one, each with its next sample. */
void store_link_up(struct store *store, int source, int64_t now_mono_ns);
/* Records that a source is not connected, and nothing about its tags: whoever mirrors is told of each of them. */
void store_link_down(struct store *store, int source, int64_t now_mono_ns);
/* Sets the alarm that a tag's readings carry from now on (enum alarm_kind) and its state (enum alarm_status). */
void store_set_alarm(struct store *store, int tag, int alarm, int status);
bool store_link_is_up(const struct store *store, int source);
/* Copies all readings, with their qualities as of now, into a snapshot that was made for the same plant. */
void store_snapshot(struct store *store, int64_t now_mono_ns, int64_t now_utc_ns, struct snapshot *into);
/* Likewise, for whoever watches (store_watch), who is told of changes after this one. Returns the monotonic time of the next change of a
   quality that time alone brings; INT64_MAX: there is none. */
int64_t store_take(struct store *store, int64_t now_mono_ns, int64_t now_utc_ns, struct snapshot *into);

#endif
