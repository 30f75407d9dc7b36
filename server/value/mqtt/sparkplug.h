/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes the messages of Sparkplug B nodes and devices, from birth to death certificate, with their aliases, types, session
   and sequence numbers. Call from one thread only. */
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
    const char *source; /* id that the plant file gives to the MQTT source, for log lines */
    const struct plant *plant;
    const struct mqtt_topics *topics; /* topics of the form GROUP/NODE[/DEVICE] */
    struct store *store;
    struct stamped_writer *writer;
    counter *gaps, *historical; /* counters of gaps in the sequence numbers, and of historical metrics; NULL: not counted */
    bool rebirth;               /* true: nodes may be requested to send their birth certificates, by calling ask() */
    void (*ask)(void *arg, const char *group, const char *node);
    void *arg;
};

/* Creates a decoder. Everything that `params` points to must outlive the decoder. */
struct sparkplug *sparkplug_create(const struct sparkplug_params *params);
void sparkplug_destroy(struct sparkplug **sparkplug); /* Frees the decoder and sets *sparkplug to NULL. *sparkplug may be NULL. */
/* Returns the topic filters to which the client must subscribe; *count receives their number. The caller frees each filter and the array
   with mem_free(). */
char **sparkplug_subscriptions(const struct sparkplug *sparkplug, size_t *count);
/* Called when the client has subscribed again: marks all nodes as not alive, because a node may have died meanwhile. Asks all nodes for
   their birth certificates, if permitted. */
void sparkplug_on_subscribed(struct sparkplug *sparkplug, int64_t now_mono_ns);
/* Sends the requests for birth certificates that were delayed because the last request to the node was too recent. Call about once a
   second. */
void sparkplug_on_tick(struct sparkplug *sparkplug, int64_t now_mono_ns);
/* Processes a message; stamped_writer_begin() must be called before. Returns false with the reason in `why` if the message is refused. */
bool sparkplug_take(struct sparkplug *sparkplug, const struct mqtt_message *message, char why[200]);

#endif
