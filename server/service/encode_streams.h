/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Encode streams: which clients share one stream of packets. A packet may need the one before it (H.264, or only what changed), so each
   client is a member of a stream and has a position in it. Clients of one view share a stream; one that missed packets is given those it
   lacks, or a key frame. Pure: time is handed in. Thread: under the lock of the encode queue. */
#ifndef SERVICE_ENCODE_STREAMS_H
#define SERVICE_ENCODE_STREAMS_H
#include "service/request_group.h"

enum { ENCODE_STREAM_KEPT = 32 };
struct encode_stream {
    struct encode_stream *next;
    void *work;                              /* the owner's; NULL in a new one */
    uint64_t planned;                        /* number of its newest frame, from 1, encoded or not */
    uint64_t oldest;                         /* lowest number whose packet is still kept */
    uint64_t key;                            /* number of the newest key frame; 0: none */
    int64_t key_ns;                          /* when that was planned */
    struct frame_request shown;              /* what the newest frame was made for: view, codec, quality */
    uint64_t content;                        /* its content hash */
    struct packet *kept[ENCODE_STREAM_KEPT]; /* packets of oldest..oldest + kept_count - 1; NULL where nothing had changed */
    int kept_count;
    size_t kept_bytes, key_bytes;
    size_t members, present; /* clients in it; those of the tickets that are being planned */
};

struct encode_stream_member {
    uint64_t client;
    struct encode_stream *stream;
    uint64_t position;                             /* the newest number that it was given */
    int64_t joined_ns, join_after_ns, patience_ns; /* a client that often falls behind has to wait longer before it may join again */
};

struct encode_streams { /* zero-initialise */
    struct encode_stream *first;
    struct encode_stream_member *links; /* by client, ascending */
    size_t link_count, link_capacity;
};

struct encode_plan { /* zero-initialise */
    struct encode_stream *stream;
    bool encode;     /* the frame is to be encoded; false: the stream's newest packet shows the same */
    bool key;        /* as a key frame */
    bool again;      /* it is to be sent even if nothing changed */
    uint64_t number; /* of the frame in the stream */
    uint64_t *from;  /* by ticket: the first number to give to its client; above `number`: there is nothing new for it */
    size_t from_capacity;
};

/* Plans how a frame reaches the clients of tickets of one codec and quality, into *plan. Tickets that cannot share are moved to `rest`,
   to be planned by another call. */
void encode_streams_plan(struct encode_streams *streams, const struct frame *frame, struct request_group *tickets, int64_t now_ns,
                         struct encode_plan *plan, struct request_group *rest);
/* Keeps the packet of the next number, with a reference of its own; NULL: nothing had changed. Packets below `needed`, the lowest number
   still to be given to somebody, may be dropped. */
void encode_stream_keep(struct encode_stream *stream, struct packet *packet, uint64_t needed);
/* Writes the packets that bring a client up to date that lacks from..to into out, oldest first, borrowed. Returns how many; -1: they are
   not kept any more. */
int encode_stream_catch_up(const struct encode_stream *stream, uint64_t from, uint64_t to, struct packet *out[ENCODE_STREAM_KEPT]);
/* Notes that the newest frame could not be encoded: all members need a key frame. */
void encode_stream_break(struct encode_stream *stream);
/* Takes the client out of its stream. */
void encode_streams_forget(struct encode_streams *streams, uint64_t client);
/* Takes out and returns a stream without members that is not busy; NULL: there is none. The caller frees its work and then calls
   encode_stream_destroy. */
struct encode_stream *encode_streams_take_empty(struct encode_streams *streams, bool (*busy)(const struct encode_stream *stream));
/* Drops its packets and frees it; leaves NULL. */
void encode_stream_destroy(struct encode_stream **stream);

#endif
