/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One connection to /stream: what the two halves of it share, life and input (stream.c) and output (sending.c). Private to them.
   Thread: the loop. */
#ifndef NET_STREAM_H
#define NET_STREAM_H
#include "net/server_context.h"
#include "message/marker_text.h"

struct stream {
    struct lws *wsi;
    struct session *session;
    struct stream *next;
    struct address_usage *peer; /* whose it is; the connection's visitor keeps it */
    int64_t in_begin_ns;        /* when the message that is coming in began */
    struct text in;             /* the message so far */
    size_t in_count;            /* its bytes, kept or not */
    struct encoded_frame *sending;
    uint32_t seq;
    enum { SEND_MARKERS, SEND_HEADER, SEND_PAYLOAD } step;
    int packet, part;                                   /* of what is being sent: which of its packets, and which part of that */
    size_t sent, sent_all;                              /* of the part; of all of it */
    bool cut;                                           /* the picture that was being sent is given up: end its message */
    uint64_t ping, pong;                                /* numbers of the last ones */
    int64_t ping_ns;                                    /* when the last ping was sent */
    enum { FIRST_TEXTS, FIRST_PING, FIRST_DONE } first; /* the texts before the first picture, and a ping behind them, tell the bandwidth */
    size_t first_bytes;
    int64_t first_ns; /* when the first of them was sent */
    struct known_markers said;
    char *carried; /* while the plant is loaded anew: what it looks at */
    bool throttled;
    int close_code; /* 0: stays open */
    const char *close_text;
    int64_t messages, errors, dropped; /* of the session, as counted already */
};

/* One write: a text, or a part of a picture. False: the connection is gone. */
bool stream_send(struct server_context *hub, struct stream *stream);
bool stream_has_output(const struct stream *stream, int64_t now_ns);
/* Frees a picture that is half sent, if it is not worth sending on. */
void stream_give_up(struct server_context *hub, struct stream *stream, int64_t now_ns);
struct stream *stream_called(const struct server_context *hub, uint64_t number); /* by the number that clients know; NULL: not connected */
void follow_resolve(struct server_context *hub, struct stream *stream);          /* its session may have asked to follow another */
bool follow_spread(struct server_context *hub, const struct stream *leader);     /* its view changed. False: nobody follows it */
void follow_share_steps(struct server_context *hub);                             /* every tick */
void follow_forget(struct server_context *hub, const struct stream *leader);     /* it goes, who led or followed */
void follow_tell(struct server_context *hub, int64_t now_ns);                    /* every tick: leaders learn who follows them */
void stream_on_pong(struct stream *stream, const void *bytes, size_t count);

#endif
