/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The encode queue: encodes frames on the worker threads, once for all clients that share an encode stream. Each client gets
   the packets (encoded frames) of its stream in order. Call from any thread. */
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
    const char *h264_library; /* name of the libavcodec encoder */
    /* Callback on a worker, for each ticket (frame request whose drawing has begun). It gets the packets (encoded frames) that
       bring the ticket's client up to date, oldest first. count 0: the frame could not be encoded if `failed` is true;
       otherwise the client already shows this content. The packets are valid only during the call. */
    void (*done)(void *arg, const struct request_ticket *ticket, struct packet *const *packets, int count, bool failed);
    void (*all_done)(void *arg); /* callback on a worker after the last ticket of a frame */
    void *done_arg;              /* argument of both callbacks */
};

struct encode_queue *encode_queue_create(const struct encode_queue_params *params); /* never returns NULL */
/* Waits for running jobs, frees everything and sets *queue to NULL; accepts a pointer to NULL. */
void encode_queue_destroy(struct encode_queue **queue);
/* Queues jobs that encode the frame: one for each codec and quality in the group, and one for each client that cannot share a packet
   stream. Takes its own reference to the frame; empties the group. */
void encode_queue_submit(struct encode_queue *queue, struct frame *frame, struct request_group *group);
/* Frees the encoders that belong to no stream any more (a stream serves clients that get the same packets). */
void encode_queue_drop_idle(struct encode_queue *queue);
/* Removes a client from its encode stream: it gets no more packets. */
void encode_queue_forget(struct encode_queue *queue, uint64_t client);
/* Frees streams without clients. Call it after encode_queue_forget(), without holding any lock. */
void encode_queue_sweep(struct encode_queue *queue);

#endif
