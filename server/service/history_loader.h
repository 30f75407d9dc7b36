/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Instants for those who travel in time, read on a thread of their own: nobody who looks at now ever waits for the disk. Of each client
   the newest wish counts. What is read goes to the snapshot cache, where drawing finds it. Thread: any. */
#ifndef SERVICE_HISTORY_LOADER_H
#define SERVICE_HISTORY_LOADER_H
#include "base/log.h"
#include "plant/plant.h"
#include "value/snapshot_cache.h"

struct history_loader_answer { /* mem_free */
    uint64_t client;
    int64_t at_us;
    bool good; /* it can be taken from the moments; else history could not be read (logged) */
    struct history_loader_answer *next;
};

struct history_loader_params {
    struct log *log;
    const struct plant *plant;
    const char *folder;
    struct snapshot_cache *snapshot_cache; /* outlive it, all of them */
    void (*notify)(void *arg);             /* called on the thread when there is an answer */
    void *notify_arg;
};

struct history_loader;
struct history_loader *history_loader_create(const struct history_loader_params *params); /* NULL: no thread, logged */
void history_loader_destroy(struct history_loader **past);                                /* &NULL is fine; leaves NULL */
void history_loader_ask(struct history_loader *past, uint64_t client, int64_t at_us);
void history_loader_forget(struct history_loader *past, uint64_t client);
struct history_loader_answer *history_loader_collect(struct history_loader *past); /* oldest first; NULL: none */
int64_t history_loader_first_us(struct history_loader *past); /* what was recorded begins there; 0: not known yet, or nothing is there */

#endif
