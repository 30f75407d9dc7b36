/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The encode queue: has frames encoded by the workers, once for all clients that share an encode stream. Each client gets the packets of
   its stream in order. Thread: any. */
#ifndef SERVICE_ENCODE_QUEUE_H
#define SERVICE_ENCODE_QUEUE_H
#include "base/metrics/counters.h"
#include "base/workers.h"
#include "service/request_group.h"

struct encode_queue;
struct encode_queue_params {
    struct log *log;
    struct workers *workers;
    struct counters *counters;
    const char *h264_library; /* an encoder of libavcodec */
    /* Called on a worker for each ticket, with the packets that bring its client up to date, oldest first; count 0: it shows the same
       already, or, when failed, the frame could not be encoded. The packets are borrowed for the call. */
    void (*done)(void *arg, const struct request_ticket *ticket, struct packet *const *packets, int count, bool failed);
    void (*all_done)(void *arg); /* called after the last ticket of one frame */
    void *done_arg;              /* of both */
};

struct encode_queue *encode_queue_create(const struct encode_queue_params *params); /* never NULL */
/* Waits for the jobs under way, then frees all. &NULL is fine; leaves NULL. */
void encode_queue_destroy(struct encode_queue **queue);
/* Queues jobs that encode the frame: one for each codec and quality in the group, and one for each client that cannot share. Takes its
   own reference on the frame; empties the group. */
void encode_queue_submit(struct encode_queue *queue, struct frame *frame, struct request_group *group);
/* Destroys encoders that no stream uses. */
void encode_queue_drop_idle(struct encode_queue *queue);
/* Takes the client out of its stream: it gets no more packets. */
void encode_queue_forget(struct encode_queue *queue, uint64_t client);
/* Frees streams that have no client left. To be called after encode_queue_forget, without the caller's locks. */
void encode_queue_sweep(struct encode_queue *queue);

#endif
