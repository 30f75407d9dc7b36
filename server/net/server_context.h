/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The server context: state shared by the parts of the event loop. Private to net/. Call only in the event loop. */
#ifndef NET_SERVER_CONTEXT_H
#define NET_SERVER_CONTEXT_H
#include <libwebsockets.h>

#include "access/openid/openid.h"
#include "base/log/log_pace.h"
#include "message/alarm_text.h"
#include "message/marker_text.h"
#include "net/address_limits.h"
#include "net/core_loss.h"
#include "net/denials.h"
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

struct stream;        /* defined in stream.h */
struct http_exchange; /* defined in http_impl.h */
struct web_site;      /* defined in site.h */

/* WALL_DISPLAYS_SEEN: maximum number of wall displays in the list of those that have connected since the daemon's start
   (wall_displays.c) */
enum { WALL_DISPLAYS_SEEN = 256 };
struct wall_displays {
    struct wall_seen {
        char wall[NAMED_VIEW_ID_BYTES];
        int display;
        /* connected_ns: monotonic time of the oldest picture on this display, so all its pictures are at least this recent; 0:
           the display is not connected. fresh_ns: the last such time, kept after the display disconnects */
        int64_t connected_ns, fresh_ns;
        counter *age;
    } at[WALL_DISPLAYS_SEEN];
    size_t count;
};

/* Picture that spans the displays of a wall; one entry for each wall (tile_walls.c). */
struct tile_wall {
    char wall[NAMED_VIEW_ID_BYTES]; /* id of the wall; "": this element of the array is not used */
    uint64_t leader;                /* id of the session that leads the wall's picture, so that the other displays follow it; 0: none */
    /* asked: id of the newest picture of the wall that was requested; presented: id of the newest picture that the displays
       were told to show */
    uint64_t asked, presented;
    /* size of the wall's picture, adapted to how long the server takes to draw and encode the picture */
    struct picture_size made;
};

enum { UPGRADE_REFUSALS = 16 };

struct server_context {
    struct net_params params;
    struct session_context session_context; /* state that all sessions read */
    struct lws_context *lws;
    struct { /* newest snapshot of the readings, and state of the connections to their sources (readings.c) */
        struct snapshot *snapshot;
        uint32_t *changes;      /* by tag: the change counter (reading.changes) of the reading in the last snapshot */
        int64_t data_ns;        /* monotonic arrival time of the oldest reading that changed in the last snapshot */
        /* monotonic time when the quality of a reading next changes because of its age; INT64_MAX: never */
        int64_t next_change_ns;
        bool *links_up; /* by source: true: the data source is connected */
        /* data_changed: readings have changed since streams and renderers were last informed; links_changed: the same for
           connections to data sources */
        bool data_changed, links_changed;
        /* monotonic time when the daemon last did not record this kind of entry (enum unrecorded); 0: it always recorded it */
        int64_t unrecorded_ns[UNRECORDED_COUNT];
    } readings;
    struct history_queries *history_queries; /* NULL: nothing is recorded */
    struct history_loader *history_loader;   /* service that loads the readings of past instants; NULL: nothing is recorded */
    struct {
        struct picture_signer *signer; /* signer of pictures; NULL: pictures are not signed */
        char key_id[SIGNING_KEY_ID_BYTES];
    } signing;
    struct {                   /* connections to /stream */
        struct stream *first;  /* linked list of all connections to /stream */
        struct stream **by_client; /* array of all connections to /stream, sorted by session id, ascending */
        size_t by_client_capacity;
        int count;
        uint64_t next_client;
        /* true: a session has timed work within the next second, so the event loop does the sessions' periodic work at the
           short interval */
        bool restless;
        /* time for drawing and reading back the last refined frame (detailed, for a camera at rest) that was drawn for only one
           session */
        int64_t still_ns;
    } streams;
    struct {
        struct view_token_keys token_keys;      /* renderers only: keys that sign view tokens */
        char key[2 * VIEW_TOKEN_KEY_BYTES + 1]; /* cores only: view token key for the renderers, hexadecimal; "": none */
        char loads[17];                         /* cores only: configuration (hash) that this core began to load last */
        char refused[400]; /* last refusal of a renderer that was logged, so that repetitions are not logged */
        struct denials denials; /* leading cores only: the last refused nodes that may be the standby (renderers_deny()) */
        bool listed;       /* renderers only: true: since the plant was loaded, the core has sent its lists (views, notes and so on) */
        /* configuration named in the core's last refusal of this daemon, which then loaded its files again to match it */
        char followed[64];
        bool reloads; /* standbys only: true: the leader announced a reload and has neither accepted nor refused this core since */
        struct renderer_peer *renderers;        /* list of all connections to /core (renderers.c) */
        /* sequence number of the newest state of alarm notifications that was sent to a standby core */
        uint64_t told_number;
    } core;
    struct {
        struct http_exchange *waiting; /* list of HTTP requests that wait for a frame, a pick or a reload */
        int pictures, questions;       /* numbers of HTTP requests in progress: pictures: for pictures; questions: for recorded history */
        int64_t answer_bytes;          /* total bytes of HTTP answers that clients have not read yet */
        int64_t upload_bytes;          /* total size of the files being uploaded, each counted at its full size from the start */
        int uploads;                   /* number of uploads in progress */
        struct web_site *site;         /* the web client's files */
        char *content_policy;          /* header Content-Security-Policy of every answer */
        struct log_pace stuck_heads;   /* rate limit of log lines about requests whose headers did not end (stuck_head.h) */
    } http;
    struct {
        const struct quotas *quotas;
        struct address_limits *addresses;
        struct admission admission;
        int connections, unanswered; /* unanswered: connections that wait for an answer or have not sent a request yet */
    } room;
    struct {
        struct tokens *tokens;           /* access tokens; NULL: none are configured */
        struct openid *openid;           /* service for signing in with OpenID Connect; NULL: off */
        struct login_throttle *throttle;
        char *notice;      /* text that the page shows before users sign in; NULL: none */
        /* number of tokens that were left unchecked, because their address had sent too many wrong ones, since the audit trail
           last got a line with this number */
        int64_t held;
        /* monotonic time when the audit trail last got a line about tokens left unchecked because their address is throttled */
        int64_t held_ns;
        /* number of the identity provider's answers that failed or belonged to no sign-in, since the audit trail last got a
           line with this number */
        int64_t unasked;
        int64_t looked_ns; /* monotonic time when the files of tokens and certificate were last checked */
    } logins;
    struct {
        bool hands_over; /* true: this leading core is handing the lead to its standby; users' messages are ignored meanwhile */
        /* during a handover of the lead: monotonic time when this core's state stopped changing; once the standby has received
           this state, it can take over. 0: the state may still change */
        int64_t lead_ended_ns;
        bool goes_down;    /* true: the server shuts down; connections are closed after their answer */
        char goodbye[64];  /* reason that streams send when they are closed at shutdown */
        int64_t drain_ns;  /* monotonic time when the daemon began to drain its sessions to other daemons; 0: it does not drain */
        struct core_loss core_loss;
        int start_s; /* seconds that the daemon took to start, rounded up; 0: still starting */
    } life;
    struct { /* texts that are made once and sent to several sessions */
        struct tag_text_cache tags;
        char *lists[LISTS];
        struct alarm_text_cache alarms;
        uint64_t alarms_number;           /* sequence number of the newest change of alarms that was sent to sessions */
        struct marker_text_cache markers; /* JSON lists of sensor markers of the frame that was sent last, for all its clients */
        struct neighbour_text_cache neighbours;
    } texts;
    struct tls *tls;   /* NULL: no TLS */
    bool local_only;   /* true: the server listens on a loopback address, without a proxy in front */
    char machine[256]; /* host name of this machine; "": not known */
    struct kept_answers kept_answers;
    uint8_t out[LWS_PRE + SLICE_BYTES]; /* buffer for writes: libwebsockets writes its framing into the LWS_PRE bytes before the data */
    struct {
        struct log_pace pace; /* rate limit of log lines about stream requests without the header Upgrade */
        struct upgrade_refusal {
            char address[64]; /* address of the client whose WebSocket handshake was refused */
            int64_t at_ns;    /* monotonic time when the WebSocket handshake was refused */
            char why[120];
        } refused[UPGRADE_REFUSALS]; /* ring buffer of refused handshakes */
        unsigned count;              /* number of WebSocket handshakes refused since the start */
    } upgrade;
    struct latency_stages latency;
    struct wall_displays displays;
    struct tile_wall tile_walls[WALLS];
    struct {
        counter *sessions, *sessions_all, *frames, *frame_bytes, *depth_bytes, *messages, *errors, *dropped, *given_up, *stalled, *requests,
            *refused, *connections, *busy, *clock_set, *clock_error, *clock_leap, *renderers, *standby_files, *logins_wrong, *logins_held,
            *logins_slowed;
    } counters;
};

/* Returns the server context to which a libwebsockets connection belongs. */
static inline struct server_context *server_context_of(struct lws *wsi)
{
    return lws_context_user(lws_get_context(wsi));
}

/* Writes up to SLICE_BYTES bytes to a connection. Returns false if the connection is gone. */
bool net_write(struct server_context *server, struct lws *wsi, const void *bytes, size_t count, enum lws_write_protocol how);

/* --- readings.c --- */

/* Takes a new snapshot if the last one is older than 100 ms. The event loop announces changes to streams and renderers
   afterwards. Call it before sending ages of readings and before acting on a message. */
void net_refresh_readings(struct server_context *server);

/* --- stream.c, stream_table.c, stream_upgrade.c: connections to /stream --- */

/* Handles the events of a connection to /stream for libwebsockets. */
int stream_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len);
/* Returns whether that client is a connected stream, not an HTTP request. */
bool stream_owns(const struct server_context *server, uint64_t client);
/* The functions stream_on_...() pass an answer to the stream whose client asked for it; the stream must be connected.
   stream_on_frame() takes ownership of the frame. */
void stream_on_frame(struct server_context *server, struct encoded_frame *encoded);
void stream_on_pick(struct server_context *server, const struct pick_answer *answer);
/* Sends a frame that picture_signer returned: signed, or unsigned if signing failed. Takes ownership of signing->encoded; the caller frees
   the rest of the struct. */
void stream_on_signed(struct server_context *server, struct signing *signing);
void stream_on_historical_snapshot(struct server_context *server, const struct history_loader_answer *answer);
/* stream_on_coverage() passes a copy of the sensor coverage (how well sensors cover an asset) to the stream whose client asked
   for it; stream_say() passes a text. Both do nothing if the stream has gone. */
void stream_on_coverage(struct server_context *server, const struct sensor_coverage_answer *answer);
void stream_say(struct server_context *server, uint64_t client, const char *text);
/* Tells sessions with sensors moved on trial that the geodesic distances from these sensors are computed. */
void streams_on_placed(struct server_context *server);
/* Does the timed work of all sessions, and sets server->streams.restless if a session has timed work within the next second. */
void streams_on_tick(struct server_context *server);
/* Tells all sessions that readings, or the connection states of sources, changed. */
void streams_on_readings(struct server_context *server, bool data_changed, bool links_changed);
/* Makes all sessions send the alarms that have changed to their clients. */
void streams_on_alarms(struct server_context *server);
/* Sends answers to users' actions that are on disk by now, or could not be written. */
void streams_settle(struct server_context *server);
/* Closes sessions whose token is no longer valid. */
void streams_check_tokens(struct server_context *server, int64_t now_utc_ns);
/* Begins to close all connections, because the server shuts down. */
void streams_close(struct server_context *server);
/* Checks the HTTP request that opens a WebSocket. Returns 0 to accept it, or 1 after refusing it with an HTTP error such as
   401, 403 or 429. */
int stream_check_upgrade(struct server_context *server, struct lws *wsi);

/* --- http/ --- */

/* Handles the events of an HTTP connection, for libwebsockets. */
int http_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len);
/* The functions http_on_...() pass an answer to the HTTP request that waits for it; they do nothing if it no longer waits. http_on_frame()
   takes ownership of the frame; http_on_history_answer() may take the text. */
void http_on_frame(struct server_context *server, struct encoded_frame *encoded);
void http_on_signed(struct server_context *server, struct signing *signing);
void http_on_pick(struct server_context *server, const struct pick_answer *answer);
void http_on_historical_snapshot(struct server_context *server, const struct history_loader_answer *answer);
void http_on_history_answer(struct server_context *server, struct history_answer *piece);
/* Answers browsers that the identity provider has sent back after a sign-in. */
void http_on_sign_ins(struct server_context *server);
/* Answers the HTTP requests for a reload up to this number (reload_ask()), once it is done. good: the new plant is loaded; text: the
   result as JSON. */
void http_on_reloaded(struct server_context *server, uint64_t number, bool good, const char *text);
/* Answers all HTTP requests that wait for something of the present plant, which is about to be destroyed. */
void http_release_plant(struct server_context *server);
/* Answers HTTP requests whose line of the audit trail has reached the disk or could not be written. */
void http_settle(struct server_context *server);
/* Answers HTTP requests that have waited too long for a frame, pick or reload. */
void http_on_tick(struct server_context *server, int64_t now_ns);
/* Sends a complete short answer in plain text. Returns the result for the libwebsockets callback. */
int http_answer(struct lws *wsi, int status, const char *text);

#endif
