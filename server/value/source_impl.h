/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The interface that each kind of source implements, with a line in the table of source.c. Private to value/. */
#ifndef VALUE_SOURCE_IMPL_H
#define VALUE_SOURCE_IMPL_H
#include <pthread.h>

#include "value/source.h"

struct source { /* first member of the struct of each kind */
    const struct source_impl *impl;
    struct log *log;
    const struct plant *plant;
    const struct plant_source *config;
    int index; /* in plant->sources */
    struct store *store;
    int stop_fd; /* an eventfd that becomes readable when the thread is to end */
    pthread_t thread;
    bool has_thread;
};

struct source_impl {
    const char *kind;
    /* Makes a source that begins with a copy of *base; its thread does not run yet. Returns NULL if it cannot, logged. */
    struct source *(*create)(const struct source *base, struct counters *counters);
    /* Runs the thread until stop_fd becomes readable, or nothing more can come. */
    void (*run)(struct source *source);
    /* Ends a wait of the thread that does not look at stop_fd. Thread: any. NULL: there is none. */
    void (*interrupt)(struct source *source);
    /* Frees the source; its thread has ended, or never ran. */
    void (*destroy)(struct source *source);
};

/* Makes a source of the kind params->impl and starts its thread. params: all but stop_fd and thread; config may be NULL for a kind that is
   not in the table. what: its name in the log. Returns NULL on failure, logged. The caller ends it with source_stop(). */
struct source *source_begin(const struct source *params, const char *what, struct counters *counters);

/* Registers the metric plantcast_source_NAME{source="ID"MORE}. more: further labels, such as ",result=\"ok\"", or "". */
counter *source_counter(const struct source *source, struct counters *counters, const char *name, const char *more, const char *type,
                        const char *help);

extern const struct source_impl modbus_impl; /* Modbus TCP and RTU, read only */
extern const struct source_impl mqtt_impl;   /* what is published to an MQTT broker; subscribes only */
extern const struct source_impl opcua_impl;  /* OPC UA subscriptions, where the build has its library; subscribes only */
extern const struct source_impl replay_impl; /* recorded series from a CSV file (series.h), at the speed that the plant file sets */

#endif
