/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Encode streams: which clients share one stream of packets (encoded frames). A packet may depend on the previous one (H.264,
   or a picture of changes only), so each client belongs to one stream and has a position in it. Clients of one view share a
   stream. A client that missed packets gets them later, or gets a key frame. Pure: the caller passes the time. Call only under
   the lock of the encode queue. */
#ifndef SERVICE_ENCODE_STREAMS_H
#define SERVICE_ENCODE_STREAMS_H
#include "service/request_group.h"

enum { ENCODE_STREAM_KEPT = 32 };
struct encode_stream {
    struct encode_stream *next;
    void *work;                 /* the encode queue's data about this stream (struct stream_work); NULL in a new stream */
    uint64_t planned;           /* sequence number of the newest planned frame, from 1; includes frames that were then not encoded */
    uint64_t oldest;            /* lowest sequence number among the frames whose packets are kept */
    uint64_t key;               /* sequence number of the newest key frame; 0: none */
    int64_t key_ns;             /* monotonic time when the newest key frame was planned */
    struct frame_request shown; /* request for the newest frame: its view, codec and quality */
    uint64_t content;           /* content hash of the newest frame: equal for frames that show the same picture */
    bool has_depth;             /* true: a depth grid was sent with the newest content */
    /* packets kept for clients that missed some: those of the frames `oldest` to oldest + kept_count - 1; an element is NULL if
       nothing had changed in its frame */
    struct packet *kept[ENCODE_STREAM_KEPT];
    int kept_count;
    size_t kept_bytes, key_bytes;
    /* members: number of clients in the stream; present: number of these that have a ticket in the group of requests that is
       being planned */
    size_t members, present;
};

struct encode_stream_member {
    uint64_t client;
    struct encode_stream *stream;
    uint64_t position; /* sequence number of the newest packet passed on to the client */
    /* joined_ns: when the client joined the stream; patience_ns: delay before a key frame is made to let the client join again,
       longer if it often falls behind; join_after_ns: end of that delay */
    int64_t joined_ns, join_after_ns, patience_ns;
};

struct encode_streams { /* zero-initialise */
    struct encode_stream *first;
    struct encode_stream_member *links; /* clients and their positions in a stream, sorted by client id */
    size_t link_count, link_capacity;
};

struct encode_plan { /* zero-initialise */
    struct encode_stream *stream;
    bool encode;     /* true: encode the frame; false: the stream's newest packet already shows the same picture */
    bool key;        /* true: encode the frame as a key frame, which decodes without earlier frames */
    bool again;      /* true: send the frame even if the client already shows the same content */
    uint64_t number; /* sequence number that the frame gets in its stream */
    /* [ticket]: sequence number of the first packet that the ticket's client needs; above `number`: it needs none */
    uint64_t *from;
    size_t from_capacity;
};

/* Plans which packets bring a frame to the clients of the requests (tickets), which all have the same codec and quality; fills
   *plan. Moves tickets whose clients cannot share one stream to `rest`; the caller plans these with another call. */
void encode_streams_plan(struct encode_streams *streams, const struct frame *frame, struct request_group *tickets, int64_t now_ns,
                         struct encode_plan *plan, struct request_group *rest);
/* Stores the packet of the stream's next frame, with a reference, for clients that missed it. packet NULL: nothing had changed
   in the frame. May drop packets with a sequence number below `needed`, the lowest that a client still has to get. */
void encode_stream_keep(struct encode_stream *stream, struct packet *packet, uint64_t needed);
/* Writes to `out` the packets with sequence numbers from..to, which bring a client up to date, oldest first. The packets are
   borrowed. Returns their count, or -1 if some were dropped already. */
int encode_stream_catch_up(const struct encode_stream *stream, uint64_t from, uint64_t to, struct packet *out[ENCODE_STREAM_KEPT]);
/* Records that the newest frame could not be encoded; all clients of the stream get a key frame next. */
void encode_stream_break(struct encode_stream *stream);
/* Removes a client from its encode stream. */
void encode_streams_forget(struct encode_streams *streams, uint64_t client);
/* Removes from the list and returns a stream without clients and without a running job; NULL: there is none. The caller frees
   the stream's `work` and then calls encode_stream_destroy(). */
struct encode_stream *encode_streams_take_empty(struct encode_streams *streams, bool (*busy)(const struct encode_stream *stream));
/* Releases the stream's packets and frees it; sets *stream to NULL. */
void encode_stream_destroy(struct encode_stream **stream);

#endif
