/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A renderer's link to its core, on a thread of its own. It writes readings, connection states of sources, and alarms into the store and
   the alarm service, and sends the actions of operators to the core. When the core is lost, or silent for CORE_SILENT_NS, all readings
   become Bad immediately. The link tries to reconnect until it is stopped. */
#ifndef CORELINK_CORE_LINK_H
#define CORELINK_CORE_LINK_H
#include "alarm/alarm_service.h"
#include "base/log/log.h"
#include "base/metrics/counters.h"
#include "corelink/lease_keeper.h"
#include "history/historian.h"
#include "value/store.h"

#define CORE_SILENT_NS (2 * INT64_C(1000000000))
enum { CORE_URLS = 4, CORE_ACTS = 256 /* maximum number of forwarded user actions that wait for the core's answer */ };

struct core_link_params {
    struct log *log;
    struct counters *counters;
    const struct plant *plant;
    struct store *store;
    struct plant_clock *clock;           /* clock that is set to the core's time */
    /* alarm service that copies the core's alarms; plant, store and alarm service must outlive the link */
    struct alarm_service *alarm_service;
    /* URL ws://HOST:PORT or wss://HOST:PORT of each core that may be the leader; tried one after the other */
    const char *urls[CORE_URLS];
    int url_count;
    const char *token_path, *ca_path; /* token_path: token file, NULL: none; ca_path: file of trusted certificates, NULL: the system's */
    const char *version, *node;       /* version of this program; name of this renderer for the core's log */
    /* standby core only: promises not to take the lead when the leader asks. NULL: this node is a renderer */
    struct lease_keeper *keeper;
    struct historian *historian;      /* standby core only: records the samples that the leader sends. NULL: nothing is recorded */
    /* standby core only: folder of the file that says which alarms the leader has announced. NULL: not stored */
    const char *folder;
    void (*notify)(void *arg);        /* called by the link's thread when core_link_collect() has new messages */
    void *notify_arg;
};

struct core_link;
/* Returns true if a URL is valid for a core: scheme, host and port, without a path. */
bool core_link_url_good(const char *url);
/* Starts the link. Returns NULL if the token cannot be read or the thread cannot be started (logged). The strings of `params` must
   outlive the link. */
struct core_link *core_link_start(const struct core_link_params *params);
/* Ends the thread. Acts (forwarded user actions) without an answer get the answer that the outcome is unknown; core_link_collect() still
   returns these answers. */
void core_link_halt(struct core_link *link);
/* Ends the thread like core_link_halt() and frees the link. Sets *link to NULL; accepts a pointer to NULL. */
void core_link_stop(struct core_link **link);
bool core_link_is_up(struct core_link *link); /* Returns whether readings arrive from a core now. Thread: any. */

/* Returns the number of the connection over which a core sends readings; 0: none does. Thread: any. */
uint64_t core_link_session(struct core_link *link);

/* HTTP address of the core. */
struct core_peer {
    char url[320]; /* http or https URL of the core, without a path */
    /* authorization: value of the HTTP header `Authorization`, empty: none; ca_path: file of trusted certificates, NULL: the system's. Both
       are valid as long as the link */
    const char *authorization, *ca_path;
};
/* Writes to *out which core sends readings now, for HTTP queries to it. Returns false if no core does. Thread: any. */
bool core_link_peer(struct core_link *link, struct core_peer *out);

struct core_act {
    uint64_t client;      /* id of this daemon's client that gets the core's answer */
    const char *from;     /* IP address of the user */
    const char *token;    /* token that the user presented to this renderer; the core verifies it. NULL: none */
    const char *id_token; /* ID token of a user who signed in at this renderer; the core verifies it. NULL: none */
    const char *text;     /* the client's message, JSON */
};
/* Sends a user's action to the core. Returns false, with nothing sent, if there is no core now or too many actions wait for an answer.
   Thread: any. */
bool core_link_act(struct core_link *link, const struct core_act *act);

/* Sends a JSON message that gets no answer. Returns false if there is no core now. Thread: any. */
bool core_link_tell(struct core_link *link, const char *text);

/* A message from the core that the event loop handles. */
struct core_arrival {
    struct core_arrival *next;
    uint64_t client; /* id of the client that gets this answer; 0: a message that is no answer: `core`, `lists`, `reloading` or `refused` */
    char *text;
};
/* Returns a list of the messages that arrived since the last call, in order; free each with core_arrival_free(). */
struct core_arrival *core_link_collect(struct core_link *link);
void core_arrival_free(struct core_arrival *arrival);

#endif
