/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Has frames encoded by the workers, with encoders that are kept from picture to picture. Thread: any. */
#ifndef NET_ENCODING_H
#define NET_ENCODING_H
#include "base/counters.h"
#include "base/workers.h"
#include "net/batch.h"

struct encoding;
struct encoding_params {
    struct log *log;
    struct workers *workers;
    struct counters *counters;
    /* On a worker: the packet answers the whole batch; NULL: it could not be made. Both belong to `encoding`. */
    void (*done)(void *arg, uint64_t content, const struct batch *batch, struct packet *packet);
    void *done_arg;
};

struct encoding *encoding_create(const struct encoding_params *params); /* never NULL */
void encoding_destroy(struct encoding **encoding);                      /* waits for its jobs; &NULL is fine; leaves NULL */
/* One packet for each codec and quality in the batch. Takes its own reference on frame; empties the batch. */
void encoding_submit(struct encoding *encoding, struct frame *frame, struct batch *batch);

#endif
