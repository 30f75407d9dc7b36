/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The interface that each kind of source implements, with a line in the table of source.c. Private to value/. */
#ifndef VALUE_SOURCE_IMPL_H
#define VALUE_SOURCE_IMPL_H
#include "value/source.h"

struct source_impl {
    const char *kind;
    /* As source_start(). */
    struct source *(*start)(struct log *log, const struct plant *plant, int source, struct store *store, struct counters *counters);
    void (*stop)(struct source *source); /* ends the thread and frees */
};

struct source { /* first member of the struct of each kind */
    const struct source_impl *impl;
};

extern const struct source_impl modbus_impl; /* Modbus TCP and RTU, read only */
extern const struct source_impl mqtt_impl;   /* what is published to an MQTT broker; subscribes only */
extern const struct source_impl replay_impl; /* recorded series from a CSV file (series.h), at the speed that the plant file sets */

#endif
