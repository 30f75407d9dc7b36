/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One connection to /stream: what the two halves of it share, life and input (stream.c) and output (sending.c). Private to them.
   Thread: the loop. */
#ifndef NET_STREAM_H
#define NET_STREAM_H
#include "net/hub.h"

struct stream {
    struct lws *wsi;
    struct session *session;
    struct stream *next;
    struct text in;  /* the message so far */
    size_t in_count; /* its bytes, kept or not */
    struct picture *sending;
    uint32_t seq;
    enum { SEND_MARKERS, SEND_HEADER, SEND_PAYLOAD } step;
    size_t sent; /* of the payload */
    bool throttled;
    int close_code; /* 0: stays open */
    const char *close_text;
    int64_t messages, errors, dropped; /* of the session, as counted already */
};

/* One write: a text, or a part of a picture. False: the connection is gone. */
bool stream_send(struct hub *hub, struct stream *stream);

#endif
