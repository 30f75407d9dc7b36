/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of sources. */
#include "value/source.h"

#include <string.h>

#include "value/source_impl.h"

static const struct source_impl *const table[] = { &modbus_impl, &mqtt_impl, &replay_impl };

struct source *source_start(struct log *log, const struct plant *plant, int source, struct store *store, struct counters *counters)
{
    const struct plant_source *wanted = &plant->sources[source];
    for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++)
        if (!strcmp(table[i]->kind, wanted->kind))
            return table[i]->start(log, plant, source, store, counters);
    log_err(log, "source %s: unknown kind %s", wanted->id, wanted->kind);
    return NULL;
}

void source_stop(struct source **source)
{
    if (*source)
        (*source)->impl->stop(*source);
    *source = NULL;
}
