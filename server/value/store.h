/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The store holds the newest sample of every tag. Sources write samples, any thread takes snapshots. The quality of a reading
   is the worst of the following. (1) The sample's quality. (2) The quality that follows from the sample's age. (3)
   Uncertain_SensorNotAccurate if the value has not changed for flatline_s. (4) The quality that the tag's quality tag decides.
   (5) Bad_DeviceFailure if the heartbeat of the tag's source has stopped. */
#ifndef VALUE_STORE_H
#define VALUE_STORE_H
#include <stdbool.h>
#include <stdint.h>

#include "plant/plant.h"
#include "value/snapshot.h"

struct store;

/* a tag's value and quality, as a source writes them to the store */
struct sample {
    int tag;      /* index in plant->tags */
    double value; /* value in engineering units; ignored while the quality is Bad; NaN and infinity make the quality Bad_SensorFailure */
    uint32_t quality;
};

/* Argument of a listener. The store calls listeners, in order of events, for every sample and for every tag that can no longer
   be read. A listener runs under the store's lock, so it must only copy the event and return. A link that is lost before the
   first sample causes no call, because the UTC time is not known yet; only snapshots show it. */
struct sample_event {
    int tag;
    double value;
    uint32_t quality;
    int64_t mono_ns, utc_ns;
};
typedef void store_listener(void *arg, const struct sample_event *event);
enum { STORE_LISTENERS = 6 };

struct store *store_create(const struct plant *plant); /* Creates a store for the tags of `plant`, which must outlive the store. */
void store_destroy(struct store **store);
/* After a reload: copies link states of sources with equal names from the old plant's store, and readings of tags with equal
   names that still get their values in the same way (plant_kept_signals()). The first sample of such a tag replaces the copied
   reading, even if the sample is older. Call it before a listener is added. */
void store_adopt(struct store *store, struct store *before);
/* Adds a listener for samples; a store has at most STORE_LISTENERS. */
void store_listen(struct store *store, store_listener *listener, void *arg);
/* Adds a listener that is called for samples and, by store_tell_aged(), when time alone changed the quality of a tag. */
void store_listen_all(struct store *store, store_listener *listener, void *arg);
/* Calls the listeners of store_listen_all(), because time alone changed the quality of a tag; for example, its reading became
   stale. Returns false, without a call, if a sample of the tag has arrived since event->mono_ns: that sample has already
   reported the quality. */
bool store_tell_aged(struct store *store, const struct sample_event *event);
/* Returns the monotonic time at which time alone gave a tag its current quality, because its reading or that of its quality tag
   became stale, or a heartbeat stopped. Returns now if there is no such time since the tag's newest sample. */
int64_t store_aged_ns(struct store *store, int tag, int64_t now_mono_ns);
/* Removes a listener; the store no longer calls it once this function has returned. */
void store_unlisten(struct store *store, store_listener *listener, void *arg);
/* Sets the function that is called when a reading, an alarm or a link has changed. The thread that makes the change calls it
   under the store's lock: once, and not again before store_take(). It is not called when time alone makes a reading stale;
   store_take() returns when that will be. NULL removes the callback, which is no longer called once this function has returned. */
void store_watch(struct store *store, void (*changed)(void *arg), void *arg);
/* Writes samples that arrived at this time. If reading the device failed, call store_link_lost() or store_tags_lost() instead. */
void store_write(struct store *store, const struct sample *samples, size_t count, int64_t now_mono_ns, int64_t now_utc_ns);
/* Writes samples whose time is not that of their sender, which states times. The next sample of such a tag replaces this one, even if
   the next one is older. */
void store_write_undated(struct store *store, const struct sample *samples, size_t count, int64_t now_mono_ns, int64_t now_utc_ns);
/* a reading as shown in the store of a core (daemon that reads the devices), for a daemon that gets its readings from that core */
struct mirrored {
    int tag;
    uint32_t quality; /* quality that the core shows, which takes the reading's age into account */
    double value;     /* last usable value, if has_value */
    bool has_value;
    int64_t received_mono_ns, received_utc_ns; /* arrival time of the value, on this machine's monotonic clock and in UTC */
};
/* Writes readings of a core (daemon that reads the devices) instead of samples. Their quality is the core's, and does not
   change as they get older. Listeners are not called. store_link_lost(), store_tags_lost() and store_tags_dead() apply to such
   readings too. Once this daemon has taken over from the core, a tag's first sample from this daemon's own source replaces the
   core's reading, even if the sample is older. Afterwards, the tag's `Stale s` and `Flatline s` apply. */
void store_mirror(struct store *store, const struct mirrored *readings, size_t count, int64_t now_mono_ns);
/* Records that a source cannot be read from now on. Its tags keep their last values: Uncertain_NoCommunicationLastUsableValue until
   stale_s after their arrival, then Bad_CommunicationError. Tags that never had a value are Bad_NoCommunication. */
void store_link_lost(struct store *store, int source, int64_t now_mono_ns);
/* Records that some tags cannot be read from now on, for example because one unit behind a gateway fails while others still answer. Their
   values and qualities change as after store_link_lost(). */
void store_tags_lost(struct store *store, const int *tags, size_t count, int64_t now_mono_ns);
/* Makes some tags Bad_CommunicationError immediately, even if their last values are recent, because these values must no longer be used. */
void store_tags_dead(struct store *store, const int *tags, size_t count, int64_t now_mono_ns);
/* Records that newer values of some tags may have been missed, although their source can be read. Their last values become Bad as
   after store_tags_dead() if `dead` is set. Otherwise, Good values become Uncertain_LastUsableValue. They become Bad when stale_s
   has passed since their arrival. Tags without a value do not change. */
void store_values_missed(struct store *store, const int *tags, size_t count, bool dead, int64_t now_mono_ns);
/* Records that a source can be read again. Each of its tags is usable again from its next sample on. */
void store_link_up(struct store *store, int source, int64_t now_mono_ns);
/* Records that a source is not connected, without changing its tags. For renderers (daemons that draw pictures), which receive each
   tag's state from the core. */
void store_link_down(struct store *store, int source, int64_t now_mono_ns);
/* Sets the alarm that a tag's readings show from now on: its kind (enum alarm_kind) and its state (enum alarm_status). */
void store_set_alarm(struct store *store, int tag, int alarm, int status);
bool store_link_is_up(const struct store *store, int source);
/* Returns true if the tag has had a usable value, from a sample, from the plant before a reload or from a core. */
bool store_has_value(struct store *store, int tag);
/* Copies all readings, with their qualities as of now, into a snapshot that was made for the same plant. */
void store_snapshot(struct store *store, int64_t now_mono_ns, int64_t now_utc_ns, struct snapshot *into);
/* Copies all readings into a snapshot, for the owner of the store_watch() callback; from now on, the callback reports later
   changes. Returns the monotonic time at which a quality next changes because of time alone; INT64_MAX: never. */
int64_t store_take(struct store *store, int64_t now_mono_ns, int64_t now_utc_ns, struct snapshot *into);

#endif
