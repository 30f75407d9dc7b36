/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Samples (readings in order of arrival) sent by a core to its standby, as bytes. The standby records them as the core does.
   Call from any thread. */
#ifndef CORELINK_CORE_SAMPLES_H
#define CORELINK_CORE_SAMPLES_H
#include "base/text/text.h"
#include "value/store.h"

enum {
    CORE_SAMPLES_HEAD_BYTES = 8,
    CORE_SAMPLE_BYTES = 24,
    CORE_SAMPLES_AT_ONCE = 20000, /* maximum number of samples in one message (core_samples_write()) */
    CORE_SAMPLES_MOST = 2000000   /* maximum number of queued samples */
};

/* Queue of samples to be sent to one standby. */
struct core_samples;
/* Starts queueing all samples that the store receives. The store must outlive the queue. */
struct core_samples *core_samples_listen(struct store *store);
void core_samples_end(struct core_samples **samples); /* Frees the queue and sets *samples to NULL; accepts a pointer to NULL. */
/* Moves the oldest queued samples, at most CORE_SAMPLES_AT_ONCE, to a message appended to `out`. Returns their number; 0: the
   queue is empty and nothing was appended; -1: the queue overflowed and samples are lost. */
int core_samples_write(struct core_samples *samples, struct text *out);

/* Returns true if the message was made by core_samples_write(), so that it contains samples. */
bool core_samples_is(const void *bytes, size_t count);
/* Parses a message with samples into *out (free with mem_free()), with times of this machine's monotonic clock. Returns NULL,
   or what is wrong with the message (static text). */
const char *core_samples_read(struct sample_event **out, size_t *out_count, size_t tag_count, const void *bytes, size_t count,
                              int64_t now_mono_ns);

#endif
