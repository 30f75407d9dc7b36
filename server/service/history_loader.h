/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The history loader: reads the readings of past instants on a thread of its own and puts them into the historical snapshot cache, where
   drawing finds them. Of each client the newest question counts. Thread: any. */
#ifndef SERVICE_HISTORY_LOADER_H
#define SERVICE_HISTORY_LOADER_H
#include "base/log/log.h"
#include "corelink/core_link.h"
#include "plant/plant.h"
#include "value/snapshot_cache.h"

struct history_loader_answer { /* mem_free */
    uint64_t client;
    int64_t at_us;
    bool good; /* the cache has that instant; false: history could not be read, already logged */
    struct history_loader_answer *next;
};

struct history_loader_params {
    struct log *log;
    const struct plant *plant;
    const char *folder; /* of the history; NULL: the core has it */
    struct core_link *core_link; /* of a renderer, which outlives the loader; else NULL */
    struct snapshot_cache *snapshot_cache;
    void (*notify)(void *arg); /* called on the loader's thread when there is an answer */
    void *notify_arg;
};

struct history_loader;
/* Starts the thread. Returns NULL if it cannot, already logged. What params point at must outlive the loader. */
struct history_loader *history_loader_create(const struct history_loader_params *params);
/* Ends the thread. &NULL is fine; leaves NULL. */
void history_loader_destroy(struct history_loader **loader);
/* Asks for an instant, in microseconds UTC, in place of the client's last question if that still waits. */
void history_loader_ask(struct history_loader *loader, uint64_t client, int64_t at_us);
/* Drops the client's question and answers. */
void history_loader_forget(struct history_loader *loader, uint64_t client);
/* Returns all answers, oldest first; the caller frees each with mem_free. NULL: none. */
struct history_loader_answer *history_loader_collect(struct history_loader *loader);
/* Returns the instant at which recorded history begins; 0: not known yet, or nothing is recorded. */
int64_t history_loader_first_us(struct history_loader *loader);

#endif
