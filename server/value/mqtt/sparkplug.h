/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What Sparkplug B nodes and their devices say, followed from birth to death: aliases, types, session and sequence numbers. Thread: one. */
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
    const char *source;               /* its id, for the log */
    const struct plant *plant;
    const struct mqtt_topics *topics; /* GROUP/NODE[/DEVICE] */
    struct store *store;
    struct stamped_writer *writer;
    counter *gaps, *historical;       /* NULL: not counted */
    bool rebirth;                     /* nodes may be asked for their birth certificates, by: */
    void (*ask)(void *arg, const char *group, const char *node);
    void *arg;
};

/* What params point to must outlive it. */
struct sparkplug *sparkplug_create(const struct sparkplug_params *params);
void sparkplug_destroy(struct sparkplug **sparkplug); /* &NULL is fine; leaves NULL */
/* Returns what to subscribe to, and how many; free with mem_free(), each too. */
char **sparkplug_subscriptions(const struct sparkplug *sparkplug, size_t *count);
/* Begins anew: who was born before may be dead by now. Asks all for their births, if it may. */
void sparkplug_on_subscribed(struct sparkplug *sparkplug, int64_t now_mono_ns);
/* To be called about once a second: asks those who could not be asked yet, since it was not long ago. */
void sparkplug_on_tick(struct sparkplug *sparkplug, int64_t now_mono_ns);
/* Handles a message; its writer's has begun. Returns false if it is refused, and says in why what is wrong. */
bool sparkplug_take(struct sparkplug *sparkplug, const struct mqtt_message *message, char why[200]);

#endif
