/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the parts of the loop share. Private to net/. Thread: the loop. */
#ifndef NET_SERVER_CONTEXT_H
#define NET_SERVER_CONTEXT_H
#include <libwebsockets.h>

#include "message/alarm_text.h"
#include "message/marker_text.h"
#include "net/net.h"
#include "service/history_loader.h"
#include "net/address_limits.h"
#include "service/history_queries.h"
#include "session/session.h"
#include "session/tag_text_cache.h"
#include "net/latency_stages.h"

enum { SLICE_BYTES = 32 * 1024 };

struct stream;  /* stream.c */
struct request; /* http_impl.h */

struct server_context {
    struct net_params params;
    struct session_context world;
    struct snapshot *snapshot;
    uint32_t *changes; /* reading.changes at the last tick, by tag */
    int64_t data_ns;   /* when the oldest of those that changed came in; monotonic */
    bool *links_up;
    struct lws_context *context;
    struct history_queries *recall;      /* NULL: nothing is recorded */
    struct history_loader *past;         /* likewise */
    struct stream *streams, **by_client; /* all of them; the same, by number, ascending */
    size_t by_client_capacity;
    struct request *snapshots;                       /* HTTP requests that wait for their picture */
    int stream_count, picture_count, question_count; /* the latter two for HTTP, that are being answered */
    int64_t answer_bytes;                            /* of HTTP, that were not read yet */
    const struct quotas *quotas;
    struct address_limits *peers;
    int connection_count;
    struct tokens *tokens; /* NULL: there are none */
    struct login_throttle *logins;
    char *content_policy; /* Content-Security-Policy of every answer */
    struct tls *tls;      /* NULL: there is none */
    struct admission admission;
    bool local_only;   /* bound to a loopback address, and no proxy is in front */
    char machine[256]; /* its own name; "": none */
    int64_t looked_ns; /* when the files of tokens and certificate were looked at */
    uint64_t next_client;
    bool asked;                         /* wishes were made: render_service_wake is due */
    int64_t still_ns;                   /* what the last refined picture cost that was not one before with new readings */
    uint8_t out[LWS_PRE + SLICE_BYTES]; /* lws writes its framing in front of what is sent */
    struct tag_text_cache tags_said;
    char *lists_said[2];
    struct alarm_text_cache alarms_said;
    uint64_t alarms_number;                /* as sessions were last told to look */
    struct marker_text_cache marker_lists; /* of the frame that was sent last */
    struct latency_stages stages;
    struct {
        counter *sessions, *sessions_all, *frames, *frame_bytes, *messages, *errors, *dropped, *given_up, *stalled, *requests, *refused,
            *connections, *busy, *clock_set, *logins_wrong, *logins_held, *logins_slowed;
    } counters;
};

static inline struct server_context *server_context_of(struct lws *wsi)
{
    return lws_context_user(lws_get_context(wsi));
}

/* Writes up to SLICE_BYTES through hub->out. False: the connection is gone. */
bool net_write(struct server_context *hub, struct lws *wsi, const void *bytes, size_t count, enum lws_write_protocol how);
void net_wake_render_service(struct server_context *hub); /* after all wishes of one event are made */

int stream_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len);
void stream_on_frame(struct server_context *hub, struct encoded_frame *picture); /* takes it over; false owner: destroys it */
void stream_on_pick(struct server_context *hub, const struct pick_answer *answer);
void stream_on_historical_snapshot(struct server_context *hub, const struct history_loader_answer *answer);
void stream_on_gaps(struct server_context *hub, const struct sensor_coverage_answer *answer); /* whoever asked may have gone */
void streams_on_placed(struct server_context *hub);                             /* distances of sensors that are placed came in */
void stream_say(struct server_context *hub, uint64_t client, const char *text); /* likewise */
bool stream_owns(const struct server_context *hub, uint64_t client);
void streams_on_tick(struct server_context *hub, bool data_changed, bool links_changed);
void streams_on_alarms(struct server_context *hub); /* some changed */
void streams_check_tokens(struct server_context *hub, int64_t now_utc_ns);
void streams_close(struct server_context *hub); /* server goes down */
/* 0: upgrade; 1: answered with an HTTP error. */
int stream_check_upgrade(struct server_context *hub, struct lws *wsi);

int http_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len);
void http_on_frame(struct server_context *hub, struct encoded_frame *picture); /* takes it over */
void http_on_pick(struct server_context *hub, const struct pick_answer *answer);
void http_on_historical_snapshot(struct server_context *hub, const struct history_loader_answer *answer);
void http_release_plant(struct server_context *hub); /* the plant is loaded anew: what waits for the old one is answered */
void http_on_reloaded(struct server_context *hub, bool good, const char *text);
void http_on_history_answer(struct server_context *hub, struct history_answer *recalled); /* a piece of its answer; may take its text */
/* A complete short answer in plain text. Returns what the callback is to return. */
int http_answer(struct lws *wsi, int status, const char *text);

#endif
