/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The server context: what the parts of the loop share. Private to net/. Thread: the loop. */
#ifndef NET_SERVER_CONTEXT_H
#define NET_SERVER_CONTEXT_H
#include <libwebsockets.h>

#include "access/openid/openid.h"
#include "base/log/log_pace.h"
#include "message/alarm_text.h"
#include "message/marker_text.h"
#include "net/address_limits.h"
#include "net/latency_stages.h"
#include "net/net_params.h"
#include "net/picture_signer.h"
#include "service/history_loader.h"
#include "service/history_queries.h"
#include "session/reply/reply_neighbours.h"
#include "session/reply/tag_text_cache.h"
#include "session/session.h"
#include "session/view/view_token.h"

enum { SLICE_BYTES = 32 * 1024 };

struct stream;  /* stream.h */
struct http_exchange; /* http_impl.h */
struct web_site;      /* site.h */

/* Displays of walls that were connected since the start (wall_displays.c). */
enum { WALL_DISPLAYS_SEEN = 256 };
struct wall_displays {
    struct wall_seen {
        char wall[NAMED_VIEW_ID_BYTES];
        int display;
        int64_t connected_ns, fresh_ns; /* how fresh it is, 0: it is not connected; when it was, monotonic */
        counter *age;
    } at[WALL_DISPLAYS_SEEN];
    size_t count;
};

/* Pictures over many displays, each of one wall (tile_walls.c). */
struct tile_wall {
    char wall[NAMED_VIEW_ID_BYTES]; /* "": free */
    uint64_t leader;                /* id of the session; 0: none */
    uint64_t asked, presented;      /* numbers of pictures */
    struct quality_ladder made;     /* its size: by how long pictures of it take */
};

enum { UPGRADE_REFUSALS = 16 };

struct server_context {
    struct net_params params;
    struct session_context session_context; /* what all sessions see */
    struct snapshot *snapshot;
    uint32_t *changes;      /* reading.changes in the last snapshot, by tag */
    int64_t data_ns;        /* monotonic: when the oldest reading that the last snapshot showed to have changed came in */
    int64_t next_change_ns; /* monotonic: when time alone changes a quality next; INT64_MAX: it does not */
    bool *links_up;         /* by source */
    struct lws_context *lws;
    struct history_queries *history_queries; /* NULL: nothing is recorded */
    struct history_loader *history_loader;   /* likewise */
    struct picture_signer *picture_signer;   /* NULL: pictures are not signed */
    char signing_key_id[SIGNING_KEY_ID_BYTES];
    struct stream *streams, **by_client;     /* all connections to /stream; the same, by session id, ascending */
    size_t by_client_capacity;
    struct view_token_keys token_keys;               /* of a renderer: by which views are signed */
    char core_key[2 * VIEW_TOKEN_KEY_BYTES + 1];     /* of a core: the key that it gives its renderers, hexadecimal; "": none */
    char renderer_refused[300]; /* which was refused last, and why, as logged */
    struct renderer_peer *renderers;                 /* all connections to /core (renderers.c) */
    struct http_exchange *snapshots;                 /* HTTP requests that wait for a frame, a pick or a reload */
    int stream_count, picture_count, question_count; /* the latter two: of HTTP, that are being answered */
    int64_t answer_bytes;                            /* of HTTP answers that their clients have not read yet */
    int64_t upload_bytes;                            /* sizes of files that are being uploaded, together */
    int uploads;                                     /* their number */
    const struct quotas *quotas;
    struct address_limits *limits;
    int connection_count, unanswered_count; /* the latter: of those, connections that wait for an answer, or have not asked yet */
    bool goes_down;                         /* no connection is kept for another request */
    struct tokens *tokens; /* NULL: none are configured */
    struct openid *openid; /* NULL: nobody signs in */
    struct login_throttle *login_throttle;
    struct web_site *site; /* the page's files */
    char *notice;         /* that is shown before somebody signs in; NULL: none */
    char *content_policy; /* Content-Security-Policy of every answer */
    struct tls *tls;      /* NULL: no TLS */
    struct admission admission;
    bool local_only;   /* bound to a loopback address, and no proxy is in front */
    char machine[256]; /* the machine's host name; "": none */
    int64_t logins_held, held_ns; /* tokens that were not judged, and not recorded yet; when such were recorded last */
    int64_t unasked; /* answers of the identity provider that nobody waits for, or that could not be looked at; likewise */
    int64_t drain_ns;  /* monotonic: since when sessions are sent elsewhere; 0: they are not */
    int64_t looked_ns; /* when the files of tokens and certificate were last looked at */
    uint64_t next_client;
    char goodbye[64];                   /* what streams are closed with at the end */
    int start_s;                        /* that the daemon took to get ready, rounded up; 0: it is not ready */
    bool kept_answers;                  /* an answer waits until an action is on disk (session_kept.c) */
    bool restless;                      /* a session waits for what time brings: a tick is due soon */
    int64_t still_ns;                   /* what the last refined frame cost that was drawn anew */
    uint8_t out[LWS_PRE + SLICE_BYTES]; /* lws writes its framing in front of what is sent */
    struct tag_text_cache tag_texts;
    char *lists_said[LISTS];
    struct alarm_text_cache alarm_texts;
    uint64_t told_number;                  /* of the last change of what the notifier keeps that a standby was told of */
    uint64_t alarms_number;                /* of the last change of alarms that sessions were told of */
    struct marker_text_cache marker_lists; /* of the frame that was sent last */
    struct neighbour_text_cache neighbour_texts;
    struct {
        struct log_pace pace; /* pace of log lines on requests for the stream without Upgrade */
        struct upgrade_refusal {
            char address[64]; /* the client's address */
            int64_t at_ns;    /* monotonic */
            char why[120];
        } refused[UPGRADE_REFUSALS]; /* handshakes that were refused, in a ring */
        unsigned count;              /* number of all refused handshakes */
    } upgrade;
    struct log_pace stuck_heads; /* pace of log lines on requests whose heads did not end */
    struct latency_stages latency;
    struct wall_displays displays;
    struct tile_wall tile_walls[WALLS];
    struct {
        counter *sessions, *sessions_all, *frames, *frame_bytes, *messages, *errors, *dropped, *given_up, *stalled, *requests, *refused,
            *connections, *busy, *clock_set, *clock_error, *clock_leap,
            *renderers, *logins_wrong, *logins_held, *logins_slowed;
    } counters;
};

/* Returns the context of a connection's loop. */
static inline struct server_context *server_context_of(struct lws *wsi)
{
    return lws_context_user(lws_get_context(wsi));
}

/* Writes up to SLICE_BYTES to a connection. Returns false when it is gone. */
bool net_write(struct server_context *server, struct lws *wsi, const void *bytes, size_t count, enum lws_write_protocol how);

/* --- readings.c --- */

/* Takes a new snapshot if the last one is older than 100 ms: to be called before its ages are told, or a message is acted on. */
void net_refresh_readings(struct server_context *server);

/* --- stream.c, stream_table.c: connections to /stream --- */

/* Handles the events of a connection to /stream, for lws. */
int stream_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len);
/* Returns whether the client of that id is a connected stream, and not an HTTP request. */
bool stream_owns(const struct server_context *server, uint64_t client);
/* Hand an answer to the stream that asked, which must be connected. The encoded frame is taken over. */
void stream_on_frame(struct server_context *server, struct encoded_frame *encoded);
void stream_on_pick(struct server_context *server, const struct pick_answer *answer);
/* Sends a frame that is signed, if it could be; takes the frame, and leaves the rest. */
void stream_on_signed(struct server_context *server, struct signing *signing);
void stream_on_historical_snapshot(struct server_context *server, const struct history_loader_answer *answer);
/* Hand coverage of sensors, or a text, to the stream that asked, and copy it; do nothing if that has gone meanwhile. */
void stream_on_coverage(struct server_context *server, const struct sensor_coverage_answer *answer);
void stream_say(struct server_context *server, uint64_t client, const char *text);
/* Tells sessions whose sensors are placed on trial that distances were computed. */
void streams_on_placed(struct server_context *server);
/* Lets all sessions act on the time, and notes in server->restless whether any waits for it. */
void streams_on_tick(struct server_context *server);
/* Tells all sessions that readings, or the states of links, changed. */
void streams_on_readings(struct server_context *server, bool data_changed, bool links_changed);
/* Has changed alarms sent to all sessions. */
void streams_on_alarms(struct server_context *server);
/* Sends answers to actions that are on disk by now, or cannot be kept. */
void streams_settle(struct server_context *server);
/* Closes sessions whose token is not valid any more. */
void streams_check_tokens(struct server_context *server, int64_t now_utc_ns);
/* Begins to close all connections: the server goes down. */
void streams_close(struct server_context *server);
/* Checks a request to become a stream. Returns 0 to go on; 1: it was answered with an HTTP error. */
int stream_check_upgrade(struct server_context *server, struct lws *wsi);

/* --- http/ --- */

/* Handles the events of an HTTP connection, for lws. */
int http_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len);
/* Hand an answer to the HTTP request that waits for it, if it still does. The encoded frame is taken over; the text may be. */
void http_on_frame(struct server_context *server, struct encoded_frame *encoded);
void http_on_signed(struct server_context *server, struct signing *signing);
void http_on_pick(struct server_context *server, const struct pick_answer *answer);
void http_on_historical_snapshot(struct server_context *server, const struct history_loader_answer *answer);
void http_on_history_answer(struct server_context *server, struct history_answer *piece);
/* Answers browsers that came back from the identity provider. */
void http_on_sign_ins(struct server_context *server);
/* Answers those who asked for a reload. */
void http_on_reloaded(struct server_context *server, bool good, const char *text);
/* Answers all requests that wait for the plant that is about to be replaced. */
void http_release_plant(struct server_context *server);
/* Answers requests that have waited too long. */
void http_on_tick(struct server_context *server, int64_t now_ns);
/* Sends a complete short answer in plain text. Returns what the lws callback is to return. */
int http_answer(struct lws *wsi, int status, const char *text);

#endif
