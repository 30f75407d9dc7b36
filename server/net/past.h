/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Instants for those who travel in time, read on a thread of their own: nobody who looks at now ever waits for the disk. Of each client
   the newest wish counts. What is read goes to the moments, where drawing finds it. Thread: any. */
#ifndef NET_PAST_H
#define NET_PAST_H
#include "base/log.h"
#include "plant/plant.h"
#include "value/moments.h"

static const int64_t PAST_BEGINS_US = 3 * 1000000; /* ago: what is newer may not all be written yet */

struct past_answer { /* mem_free */
    uint64_t client;
    int64_t at_us;
    bool good; /* it can be taken from the moments; else history could not be read (logged) */
    struct past_answer *next;
};

struct past_params {
    struct log *log;
    const struct plant *plant;
    const char *folder;
    struct moments *moments;   /* outlive it, all of them */
    void (*notify)(void *arg); /* called on the thread when there is an answer */
    void *notify_arg;
};

struct past;
struct past *past_create(const struct past_params *params); /* NULL: no thread, logged */
void past_destroy(struct past **past);                      /* &NULL is fine; leaves NULL */
void past_ask(struct past *past, uint64_t client, int64_t at_us);
void past_forget(struct past *past, uint64_t client);
struct past_answer *past_collect(struct past *past); /* oldest first; NULL: none */
int64_t past_first_us(struct past *past);            /* what was recorded begins there; 0: not known yet, or nothing is there */

#endif
