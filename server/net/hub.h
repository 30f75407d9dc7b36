/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the parts of the loop share. Private to net/. Thread: the loop. */
#ifndef NET_HUB_H
#define NET_HUB_H
#include <libwebsockets.h>

#include "net/message/alarm_text.h"
#include "net/message/marker_text.h"
#include "net/net.h"
#include "net/past.h"
#include "net/peers.h"
#include "net/recall.h"
#include "net/session/session.h"
#include "net/session/tags_said.h"
#include "net/stages.h"

enum { SLICE_BYTES = 32 * 1024 };

struct stream;  /* stream.c */
struct request; /* http_impl.h */

struct hub {
    struct net_params params;
    struct session_world world;
    struct snapshot *snapshot;
    uint32_t *changes; /* reading.changes at the last tick, by tag */
    int64_t data_ns;   /* when the oldest of those that changed came in; monotonic */
    bool *links_up;
    struct lws_context *context;
    struct recall *recall; /* NULL: nothing is recorded */
    struct past *past;     /* likewise */
    struct stream *streams, **by_client; /* all of them; the same, by number, ascending */
    size_t by_client_capacity;
    struct request *snapshots; /* HTTP requests that wait for their picture */
    int stream_count, picture_count, question_count; /* the latter two for HTTP, that are being answered */
    int64_t answer_bytes; /* of HTTP, that were not read yet */
    const struct quotas *quotas;
    struct peers *peers;
    int connection_count;
    struct tokens *tokens;   /* NULL: there are none */
    struct logins *logins;
    char *content_policy;    /* Content-Security-Policy of every answer */
    struct tls *tls;         /* NULL: there is none */
    struct admission admission;
    bool local_only;         /* bound to a loopback address, and no proxy is in front */
    char machine[256];       /* its own name; "": none */
    int64_t looked_ns;       /* when the files of tokens and certificate were looked at */
    uint64_t next_client;
    bool asked;                         /* wishes were made: painter_go is due */
    int64_t still_ns;                   /* what the last refined picture cost that was not one before with new readings */
    uint8_t out[LWS_PRE + SLICE_BYTES]; /* lws writes its framing in front of what is sent */
    struct tags_said tags_said;
    char *lists_said[2];
    struct alarms_said alarms_said;
    uint64_t alarms_number; /* as sessions were last told to look */
    struct marker_lists marker_lists; /* of the frame that was sent last */
    struct stages stages;
    struct {
        counter *sessions, *sessions_all, *frames, *frame_bytes, *messages, *errors, *dropped, *given_up, *stalled, *requests, *refused,
            *connections, *busy, *clock_set, *logins_wrong, *logins_held, *logins_slowed;
    } counters;
};

static inline struct hub *hub_of(struct lws *wsi)
{
    return lws_context_user(lws_get_context(wsi));
}

/* Writes up to SLICE_BYTES through hub->out. False: the connection is gone. */
bool hub_write(struct hub *hub, struct lws *wsi, const void *bytes, size_t count, enum lws_write_protocol how);
void hub_go(struct hub *hub); /* after all wishes of one event are made */

int stream_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len);
void stream_on_picture(struct hub *hub, struct picture *picture); /* takes it over; false owner: destroys it */
void stream_on_pick(struct hub *hub, const struct pick_answer *answer);
void stream_on_moment(struct hub *hub, const struct past_answer *answer);
void stream_on_gaps(struct hub *hub, const struct gaps_answer *answer); /* whoever asked may have gone */
void streams_on_placed(struct hub *hub);                                /* distances of sensors that are placed came in */
void stream_say(struct hub *hub, uint64_t client, const char *text);    /* likewise */
bool stream_owns(const struct hub *hub, uint64_t client);
void streams_on_tick(struct hub *hub, bool data_changed, bool links_changed);
void streams_on_alarms(struct hub *hub); /* some changed */
void streams_check_tokens(struct hub *hub, int64_t now_utc_ns);
void streams_close(struct hub *hub); /* server goes down */
/* 0: upgrade; 1: answered with an HTTP error. */
int stream_check_upgrade(struct hub *hub, struct lws *wsi);

int http_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len);
void http_on_picture(struct hub *hub, struct picture *picture); /* takes it over */
void http_on_pick(struct hub *hub, const struct pick_answer *answer);
void http_on_moment(struct hub *hub, const struct past_answer *answer);
void http_let_go(struct hub *hub); /* the plant is loaded anew: what waits for the old one is answered */
void http_on_reloaded(struct hub *hub, bool good, const char *text);
void http_on_recall(struct hub *hub, struct recall_answer *recalled); /* a piece of its answer; may take its text */
/* A complete short answer in plain text. Returns what the callback is to return. */
int http_answer(struct lws *wsi, int status, const char *text);

#endif
