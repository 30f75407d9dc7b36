/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One connection to /stream. Private to stream*.c and net_reload.c. Thread: the loop. */
#ifndef NET_STREAM_H
#define NET_STREAM_H
#include "message/marker_text.h"
#include "net/server_context.h"

struct stream {
    struct lws *wsi;
    struct session *session;
    struct stream *next;
    struct address_usage *usage; /* of its address; the connection holds the reference */
    int64_t in_begin_ns;         /* when the message that is being received began */
    struct text in;              /* the message so far */
    size_t in_count;             /* its bytes, kept or not */
    struct encoded_frame *sending;
    uint32_t seq;
    enum { SEND_MARKERS, SEND_HEADER, SEND_PAYLOAD } step;
    int packet, part;      /* which packet of the frame is being sent, and which part of that */
    size_t sent, sent_all; /* bytes sent of that part; of the whole frame */
    bool cut;              /* the frame is given up: only the end of its message is still to be sent */
    uint64_t ping, pong;   /* numbers of the last ones */
    int64_t ping_ns;       /* when the last ping was sent */
    enum {
        FIRST_TEXTS,
        FIRST_PING,
        FIRST_DONE
    } first; /* the texts before the first frame, and a ping behind them, measure the bandwidth */
    size_t first_bytes;
    int64_t first_ns; /* when the first of them was sent */
    struct known_markers known;
    char *carried;  /* while the plant is loaded anew: the parameters of its view */
    bool throttled; /* nothing is read */
    int64_t silent_ns;  /* since when the client acknowledges no picture, 0: it does; INT64_MAX once that was logged */
    int close_code; /* 0: stays open */
    const char *close_text;
    int64_t messages, errors, dropped; /* of the session, as counted already */
};

/* --- stream_table.c --- */

/* Adds a stream whose session has the largest id so far. */
void stream_table_add(struct server_context *server, struct stream *stream);
/* Removes it; it must be in the table. */
void stream_table_remove(struct server_context *server, const struct stream *stream);
/* Returns the stream of the session with that id; NULL: it is not connected. */
struct stream *stream_find(const struct server_context *server, uint64_t client);
/* Returns the stream whose session other clients know by that number; NULL: it is not connected. */
struct stream *stream_called(const struct server_context *server, uint64_t number);

/* --- stream_send.c --- */

/* Makes one write at most: a text, a part of a frame, the end of one given up, or a ping; nothing if nothing is due. Returns false when the
   connection is gone; the caller then has lws close it, which frees the stream. */
bool stream_send(struct server_context *server, struct stream *stream);
/* Returns whether there is anything to send now. */
bool stream_has_output(const struct stream *stream, int64_t now_ns);
/* Gives up a frame that is half sent, if it is not worth sending on. */
void stream_give_up(struct server_context *server, struct stream *stream, int64_t now_ns);
/* Takes a pong: measures the round trip, and at first the bandwidth. */
void stream_on_pong(struct stream *stream, const void *bytes, size_t count);

/* --- tile_walls.c: sessions that are tiles of one picture --- */

/* Asks for the next picture of a tile's wall, and has those shown that all have, if it is time. */
void tiles_pump(struct server_context *server, const struct stream *stream);
/* Notes that tiles came, went, or were left out: chooses who leads, and tells all. leaving: a stream that is being closed, or NULL. */
void tiles_gather(struct server_context *server, const char *wall, const struct stream *leaving);
/* Leaves out who holds up others, and lets them in again. Every tick. */
void tiles_on_tick(struct server_context *server);

/* --- stream_follow.c: sessions that are shown another's view --- */

/* Resolves what the session's client asked for: to follow another, to hand over the lead, or to come back with its followers. */
void follow_resolve(struct server_context *server, struct stream *stream);
/* Tells all followers that the leader's view changed. Returns whether there are any. */
bool follow_spread(struct server_context *server, const struct stream *leader);
/* Gives all who see one view the same step of the quality ladder. Every tick. */
void follow_share_steps(struct server_context *server);
/* Releases the followers of a stream that is being closed, and its leader. */
void follow_forget(struct server_context *server, const struct stream *leader);
/* Tells leaders whose followers changed who they are. Every tick. */
void follow_tell(struct server_context *server, int64_t now_ns);

#endif
