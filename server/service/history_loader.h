/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The history loader: reads the readings of past instants on a thread of its own, and puts them into the historical snapshot
   cache, from which frames are drawn. Only the newest request of each client counts. Call from any thread. */
#ifndef SERVICE_HISTORY_LOADER_H
#define SERVICE_HISTORY_LOADER_H
#include "base/log/log.h"
#include "corelink/core_link.h"
#include "plant/plant.h"
#include "value/snapshot_cache.h"

struct history_loader_answer { /* free with mem_free */
    uint64_t client;
    int64_t at_us;
    bool good; /* true: the readings of the instant are in the cache; false: history could not be read, already logged */
    struct history_loader_answer *next;
};

struct history_loader_params {
    struct log *log;
    const struct plant *plant;
    const char *folder;          /* folder of the recorded history; NULL: the core has the history */
    struct core_link *core_link; /* on a renderer: link to the core, which must outlive the loader; otherwise NULL */
    struct snapshot_cache *snapshot_cache;
    void (*notify)(void *arg); /* called on the loader's thread when there is an answer to collect */
    void *notify_arg;
};

struct history_loader;
/* Starts the thread. Returns NULL if it cannot, already logged. Everything that params point to must outlive the loader. */
struct history_loader *history_loader_create(const struct history_loader_params *params);
/* Ends the history thread and sets *loader to NULL; accepts a pointer to NULL. */
void history_loader_destroy(struct history_loader **loader);
/* Requests the readings of the past instant at_us, in UTC microseconds. Replaces the client's last request if that one still waits. */
void history_loader_ask(struct history_loader *loader, uint64_t client, int64_t at_us);
/* Drops the client's request, and answers for the client that were not collected yet. */
void history_loader_forget(struct history_loader *loader, uint64_t client);
/* Returns all answers so far, oldest first; the caller frees each with mem_free. NULL: no answer. */
struct history_loader_answer *history_loader_collect(struct history_loader *loader);
/* Returns when recorded history begins, UTC microseconds; 0: not known yet, or nothing is recorded. */
int64_t history_loader_first_us(struct history_loader *loader);

#endif
