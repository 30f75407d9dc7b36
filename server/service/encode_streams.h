/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who shares which stream of packets. A packet may need the one before it (H.264, or only what changed), so a client belongs to a chain
   and has a place in it; clients of one view share one, and who missed some of it is given those packets, or a picture that stands alone.
   Pure: time is handed in. Thread: under its owner's lock. */
#ifndef SERVICE_ENCODE_STREAMS_H
#define SERVICE_ENCODE_STREAMS_H
#include "service/request_group.h"

enum { ENCODE_STREAM_KEPT = 32 };
struct encode_stream {
    struct encode_stream *next;
    void *work;                              /* the owner's; NULL in a new one */
    uint64_t planned;                        /* number of its newest picture, from 1; those that are not made yet count */
    uint64_t oldest;                         /* the lowest number that can still be had */
    uint64_t key;                            /* the newest that stands alone; 0: none */
    int64_t key_ns;                          /* when that was planned */
    struct frame_request shown;              /* what the newest was made for: view, codec, quality */
    uint64_t content;                        /* of it: frame->content */
    struct packet *kept[ENCODE_STREAM_KEPT]; /* of oldest..oldest + kept_count - 1; NULL where nothing had changed */
    int kept_count;
    size_t kept_bytes, key_bytes;
    size_t members, present; /* clients in it; those of the orders that are being planned */
};

struct encode_stream_member {
    uint64_t client;
    struct encode_stream *chain;
    uint64_t position;                             /* the newest number that was given to it */
    int64_t joined_ns, join_after_ns, patience_ns; /* who falls behind often is not let in soon, since the others pay for it */
};

struct encode_streams { /* zero-initialise */
    struct encode_stream *first;
    struct encode_stream_member *links; /* by client, ascending */
    size_t link_count, link_capacity;
};

struct encode_plan { /* zero-initialise */
    struct encode_stream *chain;
    bool encode;     /* the frame; else the chain's newest picture shows the same */
    bool key;        /* it has to stand alone */
    bool again;      /* it is to be sent even if nothing has changed */
    uint64_t number; /* of the picture, in the chain */
    uint64_t *from;  /* by order: the first number that it is to be given; above `number`: nothing new for it */
    size_t from_capacity;
};

/* What a frame becomes for orders of one codec and quality. Those who cannot share it go to `rest`, to be planned for by themselves. */
void encode_streams_plan(struct encode_streams *chains, const struct frame *frame, struct request_group *orders, int64_t now_ns,
                         struct encode_plan *plan, struct request_group *rest);
/* What became of the next number: the chain takes its own reference; NULL: nothing had changed. needed: the lowest number that is still
   to be given to someone. */
void encode_stream_keep(struct encode_stream *chain, struct packet *packet, uint64_t needed);
/* What brings a client that lacks from..to up to date, oldest first, into out; no references are taken. Returns how many; -1: it is
   gone. */
int encode_stream_catch_up(const struct encode_stream *chain, uint64_t from, uint64_t to, struct packet *out[ENCODE_STREAM_KEPT]);
/* The newest could not be made: all in it need one that stands alone. */
void encode_stream_break(struct encode_stream *chain);
void encode_streams_forget(struct encode_streams *chains, uint64_t client);
/* The next chain that nobody is in, taken out; NULL: none. The owner sees to its work and then calls encode_stream_destroy. */
struct encode_stream *encode_streams_take_empty(struct encode_streams *chains, bool (*busy)(const struct encode_stream *chain));
void encode_stream_destroy(struct encode_stream **chain);

#endif
