/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Connections to a server's /stream, each kept up for ever, and requests for its walls, its history and pictures of other plants. One
   thread of their own services all of them and calls back under the player's lock, but for `frame`. */
#ifndef WALL_LINK_H
#define WALL_LINK_H
#include <jansson.h>
#include <libwebsockets.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/text.h"
#include "clients/link/daemon.h"
#include "protocol/wire.h"

enum { LINKS_MOST = 26, LINK_MOST_QUEUED = 64 };
enum link_state { LINK_IDLE, LINK_WAITING, LINK_CONNECTING, LINK_OPEN, LINK_WELCOMED };

struct link;
struct link_events {
    json_t *(*hello)(struct link *link);                    /* the first message; the link frees it */
    void (*text)(struct link *link, const json_t *message); /* all but pong */
    void (*pong)(struct link *link, const json_t *message); /* its `t` is when the ping was sent, monotonic */
    /* A frame, without the lock. Returns whether it could be decoded. */
    bool (*frame)(struct link *link, const struct wire_frame *frame, const uint8_t *payload);
    void (*refused)(struct link *link); /* a token is needed, or another one */
};

struct links;
struct link {
    struct links *links;
    const struct link_events *events;
    void *arg;
    int index;
    bool wanted; /* it is to be connected */
    bool denied; /* it was not let in the last time */
    enum link_state state;
    int64_t heard_ns; /* monotonic: when the server last spoke in a session; 0: never */
    int64_t alive_ns; /* the same, also before it lets us in, or refuses to */
    /* --- below: of link.c */
    struct lws *wsi;
    bool closing, asked; /* asked: it is to end because we want another one */
    int tries, failures; /* failures: frames that could not be decoded, one after another */
    int64_t retry_ns, ping_ns, begun_ns;
    double retry_after_s;
    struct text in;
    char *queue[LINK_MOST_QUEUED];
    int queued;
};

/* A request that is made when it is asked for, one at a time. */
enum links_get { GET_WALLS, GET_HISTORY, GET_OTHER_PLANTS, GET_OTHER_PICTURE, GET_PAIRING, GET_COUNT };
struct links_request {
    int status; /* of the last answer, by HTTP; 0: there was none */
    /* --- below: of link.c */
    struct links *links;
    bool wanted, under_way;
    int64_t begun_ns;
    char *path, *authorization;
    struct text body;
};

struct links {
    pthread_mutex_t *lock;
    const struct daemon_url *url;
    struct link at[LINKS_MOST];
    /* What was answered, as JSON (NULL: it is none, or failed) and as it came (empty: it failed). Under the lock. */
    void (*got)(void *arg, enum links_get what, const json_t *answer, const struct text *body);
    /* Chooses the token (daemon.h), before the first link connects and again each time. NULL: it is read from its file. Under the lock. */
    void (*choose_token)(void *arg);
    void *arg;
    /* --- below: of link.c */
    struct lws_context *context;
    char why[200]; /* why the first link last could not connect */
    pthread_t thread;
    bool ends, started;
    struct links_request requests[GET_COUNT];
    int64_t alive_ns;
    lws_sorted_usec_list_t timer;
};

/* Starts the thread. Returns false if it cannot, with the reason printed. at[], lock and url are set by then. */
bool links_start(struct links *links);
/* Closes all, ends the thread. */
void links_stop(struct links *links);
/* Asks for a path below the server's base, as soon as may be, by a call of got(): some time after the one before of its kind at the
   earliest. Under the lock. */
void links_ask(struct links *links, enum links_get what, const char *path);
/* Likewise, with that value of the Authorization header in place of the token's. */
void links_ask_as(struct links *links, enum links_get what, const char *path, const char *authorization);
/* Returns when the thread was last seen at work, monotonic. Any thread. */
int64_t links_alive_ns(struct links *links);
/* Sends a message, which it frees, once the server has greeted; else it is dropped. Under the lock. */
void link_post(struct link *link, json_t *message);
/* Returns how long to wait for the next try, in seconds: another time at each call (rand()), so that many displays do not come at once.
   tries: how many have failed since the server last greeted, 4 at most; told_s: how long the server wants it to be, 0: it did not say. */
double link_wait_s(int tries, double told_s);
/* Ends the connection; while it is wanted another one follows at once. Under the lock. */
void link_restart(struct link *link);

#endif
