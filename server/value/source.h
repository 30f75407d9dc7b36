/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sources: the devices, servers and files from which the plant reads its tags' values. Each source has one thread, which writes to
   the store and to nothing else. */
#ifndef VALUE_SOURCE_H
#define VALUE_SOURCE_H
#include "base/log/log.h"
#include "base/metrics/counters.h"
#include "plant/plant.h"
#include "value/store.h"

struct source;

/* Starts the thread of one of the plant's sources. A device that does not answer is not an error: the source keeps retrying.
 * Returns NULL (logged) if the kind is unknown or the thread could not be started. */
struct source *source_start(struct log *log, const struct plant *plant, int source, struct store *store, struct counters *counters);
/* Ends the source's thread within 2 s, frees the source and sets *source to NULL. *source may be NULL. */
void source_stop(struct source **source);

#endif
