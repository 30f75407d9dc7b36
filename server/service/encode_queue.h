/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Has frames encoded by the workers. Each client gets packets of a chain (chains.h) in their order. Thread: any. */
#ifndef SERVICE_ENCODE_QUEUE_H
#define SERVICE_ENCODE_QUEUE_H
#include "base/counters.h"
#include "base/workers.h"
#include "service/request_group.h"

struct encode_queue;
struct encode_queue_params {
    struct log *log;
    struct workers *workers;
    struct counters *counters;
    const char *h264_library; /* an encoder of libavcodec */
    /* On a worker: what brings the client up to date, oldest first; none: it shows the same already. failed: it could not be made. The
       packets belong to `encoding`. */
    void (*done)(void *arg, const struct request_ticket *order, struct packet *const *packets, int count, bool failed);
    void (*all_done)(void *arg); /* after the last client of one packet */
    void *done_arg;              /* of both */
};

struct encode_queue *encode_queue_create(const struct encode_queue_params *params); /* never NULL */
void encode_queue_destroy(struct encode_queue **encoding);                          /* waits for its jobs; &NULL is fine; leaves NULL */
/* One packet for each codec and quality in the batch, and for those who cannot share it. Takes its own reference on frame; empties the
   batch. */
void encode_queue_submit(struct encode_queue *encoding, struct frame *frame, struct request_group *batch);
/* Encoders that nobody uses go. */
void encode_queue_drop_idle(struct encode_queue *encoding);
void encode_queue_forget(struct encode_queue *encoding, uint64_t client);
void encode_queue_sweep(struct encode_queue *encoding); /* after that: frees what nobody uses any more */

#endif
