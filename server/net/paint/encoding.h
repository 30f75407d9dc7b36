/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Has frames encoded by the workers. Each client gets packets of a chain (chains.h) in their order. Thread: any. */
#ifndef NET_ENCODING_H
#define NET_ENCODING_H
#include "base/counters.h"
#include "base/workers.h"
#include "net/paint/batch.h"

struct encoding;
struct encoding_params {
    struct log *log;
    struct workers *workers;
    struct counters *counters;
    const char *h264_library; /* an encoder of libavcodec */
    /* On a worker: what brings the client up to date, oldest first; none: it shows the same already. failed: it could not be made. The
       packets belong to `encoding`. */
    void (*done)(void *arg, const struct order *order, struct packet *const *packets, int count, bool failed);
    void (*all_done)(void *arg); /* after the last client of one packet */
    void *done_arg;              /* of both */
};

struct encoding *encoding_create(const struct encoding_params *params); /* never NULL */
void encoding_destroy(struct encoding **encoding);                      /* waits for its jobs; &NULL is fine; leaves NULL */
/* One packet for each codec and quality in the batch, and for those who cannot share it. Takes its own reference on frame; empties the
   batch. */
void encoding_submit(struct encoding *encoding, struct frame *frame, struct batch *batch);
/* Encoders that nobody uses go. */
void encoding_rest(struct encoding *encoding);
void encoding_forget(struct encoding *encoding, uint64_t client);
void encoding_sweep(struct encoding *encoding); /* after that: frees what nobody uses any more */

#endif
