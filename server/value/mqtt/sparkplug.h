/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes the messages of Sparkplug B nodes and devices, from birth to death certificate: aliases, types, session and sequence numbers.
   Thread: one. */
#ifndef VALUE_SPARKPLUG_H
#define VALUE_SPARKPLUG_H
#include "base/log/log.h"
#include "base/metrics/counter.h"
#include "value/mqtt/mqtt_client.h"
#include "value/mqtt/mqtt_topics.h"
#include "value/stamped_writer.h"

struct sparkplug;

struct sparkplug_params {
    struct log *log;
    const char *source; /* the source's id, for the log */
    const struct plant *plant;
    const struct mqtt_topics *topics; /* topics of the form GROUP/NODE[/DEVICE] */
    struct store *store;
    struct stamped_writer *writer;
    counter *gaps, *historical; /* counters of sequence gaps and of historical metrics; NULL: not counted */
    bool rebirth;               /* nodes may be asked for their birth certificates, by this callback: */
    void (*ask)(void *arg, const char *group, const char *node);
    void *arg;
};

/* Creates a decoder. All that `params` points to must outlive it. */
struct sparkplug *sparkplug_create(const struct sparkplug_params *params);
void sparkplug_destroy(struct sparkplug **sparkplug); /* Frees the decoder. &NULL is fine; leaves NULL. */
/* Returns the topic filters to subscribe to, and their count. Free each filter and the array with mem_free(). */
char **sparkplug_subscriptions(const struct sparkplug *sparkplug, size_t *count);
/* Forgets all births after a new subscription, since any node may have died in between. Asks all nodes for their births, if permitted. */
void sparkplug_on_subscribed(struct sparkplug *sparkplug, int64_t now_mono_ns);
/* Sends the birth requests that were held back because the last request to the node was too recent. Call it about once a second. */
void sparkplug_on_tick(struct sparkplug *sparkplug, int64_t now_mono_ns);
/* Processes a message; call stamped_writer_begin() before. Returns false with the reason in `why` if the message is refused. */
bool sparkplug_take(struct sparkplug *sparkplug, const struct mqtt_message *message, char why[200]);

#endif
