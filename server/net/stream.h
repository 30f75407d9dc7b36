/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One connection to /stream. Private to stream*.c and net_reload.c. Call only in the event loop. */
#ifndef NET_STREAM_H
#define NET_STREAM_H
#include "message/marker_text.h"
#include "net/server_context.h"

struct stream {
    struct lws *wsi;
    struct session *session;
    struct stream *next;
    struct address_usage *usage; /* quota usage of the client's address; the connection holds the reference */
    int64_t in_begin_ns;         /* monotonic time when the first bytes of the message being received arrived */
    struct text in;              /* bytes of the client's current WebSocket message that have arrived so far */
    /* number of bytes of the client's current message that have arrived so far. Larger than the length of `in` if the message
       is too long: its further bytes are dropped */
    size_t in_count;
    struct encoded_frame *sending;
    uint32_t seq;
    /* whether the frame comes without depth grids (SESSION_DEPTH_NONE), with grids that the client already has (SENT), or with
       grids to be sent (NEW) */
    enum session_depth depth;
    /* index of the depth grid being sent: 0: the only one, or that of the left half of a split view; 1: that of the right half */
    int half;
    enum { SEND_MARKERS, SEND_DEPTH, SEND_HEADER, SEND_PAYLOAD } step;
    int packet, part;      /* indices of the packet being sent in its frame, and of the part being sent in its packet */
    size_t sent, sent_all; /* number of bytes sent so far: sent: of the part in progress; sent_all: of the whole frame */
    bool cut;              /* true: the rest of the frame is not sent; only the end of its WebSocket message must still be written */
    uint64_t ping, pong;   /* sequence numbers of the last ping sent and of the last pong received */
    int64_t ping_ns;       /* monotonic time when the last ping was sent */
    /* progress of the first bandwidth measurement, which times the first texts from sending to the pong that follows them */
    enum { FIRST_TEXTS, FIRST_PING, FIRST_DONE } first;
    size_t first_bytes;
    int64_t first_ns; /* monotonic time when the first text was sent; used until the first frame is sent */
    struct known_markers known;
    char *carried;  /* during a plant reload: parameters of the session's view as text, for session_take_plant() */
    bool throttled; /* true: the client sent too many messages, so nothing is read from it for now */
    /* monotonic time since which the client has acknowledged no picture; 0: it acknowledges pictures; INT64_MAX once the
       silence was logged */
    int64_t silent_ns;
    int close_code; /* WebSocket close code to send; 0: the connection stays open */
    const char *close_text;
    /* numbers of the session's messages, errors and dropped frames that were already added to the server's metrics; only later
       ones are added next time */
    int64_t messages, errors, dropped;
};

/* --- stream_table.c --- */

/* Adds a stream; its session's id must be larger than all earlier ones. */
void stream_table_add(struct server_context *server, struct stream *stream);
/* Removes a stream (connection to /stream), which must be in the table. */
void stream_table_remove(struct server_context *server, const struct stream *stream);
/* Returns the stream of the session with that id; NULL: not connected. */
struct stream *stream_find(const struct server_context *server, uint64_t client);
/* Returns the stream of the session with that session number, which other clients use to follow the session; NULL: not
   connected. */
struct stream *stream_called(const struct server_context *server, uint64_t number);

/* --- stream_send.c --- */

/* Makes at most one write: a text, a part of a frame, the end of a frame that was cut short, or a ping. Does nothing if nothing
   is due. Returns false if the connection is gone; the caller then makes libwebsockets close it, which frees the stream. */
bool stream_send(struct server_context *server, struct stream *stream);
/* Returns whether there is anything to send to the stream's client now. */
bool stream_has_output(const struct stream *stream, int64_t now_ns);
/* Stops sending a half-sent frame if its remaining bytes are not worth sending any more. */
void stream_give_up(struct server_context *server, struct stream *stream, int64_t now_ns);
/* Handles a pong: measures the round trip and, at the start, the bandwidth. */
void stream_on_pong(struct stream *stream, const void *bytes, size_t count);

/* --- tile_walls.c: sessions that are tiles, that is, displays that together show one picture --- */

/* Requests the next picture of a tile's wall. (A tile is one display's part of a wall's picture.) Also presents a picture that
   all tiles have received, if its time has come. */
void tiles_pump(struct server_context *server, const struct stream *stream);
/* Chooses the tile (display with a part of one picture) that leads its wall, and informs all tiles. Call it when tiles
   connected, disconnected or were dropped. leaving: a stream that is being closed, or NULL. */
void tiles_gather(struct server_context *server, const char *wall, const struct stream *leaving);
/* Drops tiles (displays that together show one picture of a wall) that delay the wall's other tiles, and readmits them once
   they keep up. Call it in each run of the event loop's periodic work. */
void tiles_on_tick(struct server_context *server);

/* --- stream_follow.c: sessions that are shown another session's view --- */

/* Carries out the client's request about following: to follow another session, to hand over the lead, or to return with its followers. */
void follow_resolve(struct server_context *server, struct stream *stream);
/* Tells all followers of `leader` that the leader's view changed. Returns false if there are none. */
bool follow_spread(struct server_context *server, const struct stream *leader);
/* Chooses one step of the quality ladder (picture quality and size) for all viewers of one view, so that a frame is encoded
   once for all of these viewers. Call it in each run of the event loop's periodic work. */
void follow_share_steps(struct server_context *server);
/* Call it when a stream is being closed. If another connection has resumed the session's view, its followers then follow the
   resuming session; otherwise they follow nobody. */
void follow_forget(struct server_context *server, const struct stream *leader);
/* Sends each leader (session whose view other sessions follow) the list of its followers if the list changed. Call it in each
   run of the event loop's periodic work. */
void follow_tell(struct server_context *server, int64_t now_ns);

#endif
