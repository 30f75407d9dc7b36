/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The interface that each kind of source implements and registers in the table of source.c. Private to value/. */
#ifndef VALUE_SOURCE_IMPL_H
#define VALUE_SOURCE_IMPL_H
#include <pthread.h>

#include "base/mem.h"
#include "value/source.h"

struct source { /* the members that sources of all kinds have; this struct is the first member of each kind's own struct */
    const struct source_impl *impl;
    struct log *log;
    const struct plant *plant;
    const struct plant_source *config;
    int index; /* index in plant->sources */
    struct store *store;
    int stop_fd; /* eventfd that becomes readable when the thread must end */
    pthread_t thread;
    bool has_thread;
};

struct source_impl {
    const char *kind;
    /* creates a source that begins with a copy of *base; its thread is not running yet; returns NULL on failure (logged) */
    struct source *(*create)(const struct source *base, struct counters *counters);
    /* main function of the source's thread: runs until stop_fd becomes readable or no more data can arrive */
    void (*run)(struct source *source);
    /* called by any thread to interrupt a wait that does not watch stop_fd; NULL: this kind of source has no such wait */
    void (*interrupt)(struct source *source);
    /* frees the source, after its thread has ended or if it never ran */
    void (*destroy)(struct source *source);
};

/* Creates a source of the kind params->impl and starts its thread. The caller sets all members of `params` except stop_fd and thread;
   config may be NULL for a kind that cannot be named in the plant file. what: name of the source in the log. Returns NULL on failure
   (logged). The caller ends the source with source_stop(). */
struct source *source_begin(const struct source *params, const char *what, struct counters *counters);

/* Registers the metric plantcast_source_NAME{source="ID"MORE} and returns its counter. more: further labels, such as ",result=\"ok\"", or
 * "". */
static inline counter *source_counter(const struct source *source, struct counters *counters, const char *name, const char *more,
                                      const char *type, const char *help)
{
    char *full = mem_printf("plantcast_source_%s{source=\"%s\"%s}", name, source->config->id, more);
    counter *added = counters_add(counters, full, type, help);
    mem_free(full);
    return added;
}

/* sources of kind modbus: devices read over Modbus TCP or RTU; nothing is ever written to a device */
extern const struct source_impl modbus_impl;
extern const struct source_impl mqtt_impl;   /* sources of kind mqtt: values that devices publish to an MQTT broker; subscribes only */
extern const struct source_impl opcua_impl;  /* OPC UA, subscribes only; defined if the build has open62541 */
/* recorded series from a CSV file (series.h), at the speed set in the plant file */
extern const struct source_impl replay_impl;

#endif
