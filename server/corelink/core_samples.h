/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Samples from a core to the one that stands by, as bytes: each sample, in order, for its history. Thread: any. */
#ifndef CORELINK_CORE_SAMPLES_H
#define CORELINK_CORE_SAMPLES_H
#include "base/text/text.h"
#include "value/store.h"

enum {
    CORE_SAMPLES_HEAD_BYTES = 8,
    CORE_SAMPLE_BYTES = 24,
    CORE_SAMPLES_AT_ONCE = 20000, /* in one message */
    CORE_SAMPLES_MOST = 2000000   /* that wait */
};

/* What waits for one standby. */
struct core_samples;
/* Listens to the store from now on, which outlives it. */
struct core_samples *core_samples_listen(struct store *store);
void core_samples_end(struct core_samples **samples); /* &NULL is fine; leaves NULL */
/* Appends the message with samples that wait, CORE_SAMPLES_AT_ONCE at most. Returns how many; 0: none waits, nothing was appended; -1: too
   many waited, and some are lost. */
int core_samples_write(struct core_samples *samples, struct text *out);

/* Returns whether the message is one of samples. */
bool core_samples_is(const void *bytes, size_t count);
/* Reads a message into *out (mem_free), with this machine's monotonic time. Returns NULL, or what is wrong with it (static). */
const char *core_samples_read(struct sample_event **out, size_t *out_count, size_t tag_count, const void *bytes, size_t count,
                              int64_t now_mono_ns);

#endif
