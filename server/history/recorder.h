/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What of a stream of samples is to be written: each tag's through its own door. Pure; thread: one. */
#ifndef HISTORY_RECORDER_H
#define HISTORY_RECORDER_H
#include "history/month_file.h"
#include "plant/plant.h"

struct recorder_rows { /* zero-initialise; free at with mem_free */
    struct history_row *at;
    size_t count, capacity;
};

struct recorder;
struct recorder *recorder_create(const struct plant *plant);
void recorder_destroy(struct recorder **recorder); /* &NULL is fine; leaves NULL */
/* Appends what must be kept because of it. */
void recorder_put(struct recorder *recorder, int tag, const struct history_point *sample, struct recorder_rows *kept);
uint32_t recorder_quality(const struct recorder *recorder, int tag); /* of its newest sample; Bad_WaitingForInitialData: none yet */
/* Appends what is held of the tags that had a sample since the last call. */
/* It could not be written: the next call appends all that is held. */
void recorder_hold_again(struct recorder *recorder);
void recorder_held(struct recorder *recorder, struct recorder_rows *held);
void recorder_end(struct recorder *recorder, struct recorder_rows *kept); /* closes all doors */

#endif
