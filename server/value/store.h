/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The latest reading of every tag. Sources write, anyone takes snapshots; the newest sample wins. Thread: any.
   A quality is the worst of: the sample's own and its age; Uncertain_SensorNotAccurate once its value has been the same for flatline_s;
   what its quality tag says; Bad_DeviceFailure once the heartbeat of its source has stopped. */
#ifndef VALUE_STORE_H
#define VALUE_STORE_H
#include <stdbool.h>
#include <stdint.h>

#include "plant/plant.h"
#include "value/snapshot.h"

struct store;

/* What a source says of one tag. */
struct sample {
    int tag;      /* index in plant->tags */
    double value; /* engineering units; not used while quality is Bad. NaN or infinite becomes Bad_SensorFailure */
    uint32_t quality;
};

/* Hears every sample and every link that is lost, in their order, under the store's lock: it copies and returns. value: NaN if Bad.
   What is lost before the first sample of all is not told, as its UTC is not known: a snapshot has it. */
struct sample_event {
    int tag;
    double value;
    uint32_t quality;
    int64_t mono_ns, utc_ns;
};
typedef void store_listener(void *arg, const struct sample_event *event);
enum { STORE_LISTENERS = 4 };

struct store *store_create(const struct plant *plant); /* plant must outlive it */
void store_destroy(struct store **store);
/* Readings of tags, and links of sources, that go by the same name in another store: as they are there. Before anybody listens. */
void store_adopt(struct store *store, struct store *before);
void store_listen(struct store *store, store_listener *listener, void *arg);   /* at most STORE_LISTENERS of them */
void store_unlisten(struct store *store, store_listener *listener, void *arg); /* hears nothing more once this has returned */
/* Times are of arrival. A failed read is not a sample: see store_link_lost. */
void store_write(struct store *store, const struct sample *samples, size_t count, int64_t now_mono_ns, int64_t now_utc_ns);
/* The source cannot be read since now. Its tags keep their last values: Uncertain_NoCommunicationLastUsableValue until
   stale_s has passed since they arrived, then Bad_CommunicationError; those that never had one are Bad_NoCommunication. */
void store_link_lost(struct store *store, int source, int64_t now_mono_ns);
/* The same for some tags only: one unit behind a gateway is gone while others still answer. */
void store_tags_lost(struct store *store, const int *tags, size_t count, int64_t now_mono_ns);
/* Tags become usable again one by one, with their next sample. */
void store_link_up(struct store *store, int source, int64_t now_mono_ns);
/* What readings say of alarms from now on: a tag's gravest (enum alarm_kind), and how that is (enum alarm_status). */
void store_set_alarm(struct store *store, int tag, int alarm, int status);
bool store_link_is_up(const struct store *store, int source);
/* Applies staleness as of now. `into` was made for the same plant. */
void store_snapshot(struct store *store, int64_t now_mono_ns, int64_t now_utc_ns, struct snapshot *into);

#endif
