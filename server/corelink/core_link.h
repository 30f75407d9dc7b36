/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A renderer's link to its core, on a thread of its own. It writes readings, connection states of sources, and alarms to the
   store and the alarm service, and sends operators' actions to the core. When the core is lost, or silent for CORE_SILENT_NS,
   all readings become Bad immediately. The link keeps reconnecting until it is stopped. */
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
    uint64_t models_hash; /* hash of the plant's models (scene.models_hash) */
    struct store *store;
    struct plant_clock *clock;           /* this renderer's clock of the plant, which the link adjusts to the core's clock */
    /* alarm service that mirrors the core's alarms; plant, store and alarm service must outlive the link */
    struct alarm_service *alarm_service;
    /* URL ws://HOST:PORT or wss://HOST:PORT of each core that may be the leader; tried in turn */
    const char *urls[CORE_URLS];
    int url_count;
    const char *token_path, *ca_path; /* token_path: token file, NULL: none; ca_path: file of trusted certificates, NULL: the system's */
    const char *version, *node;       /* version: version of this program; node: name of this renderer, for the core's log */
    /* standby core only: lease keeper that decides about the leader's requests to promise not to take the lead
       (corelink/lease.h). NULL: this node is a renderer */
    struct lease_keeper *keeper;
    /* standby core only: historian that records the leader's samples on this machine. NULL: nothing is recorded */
    struct historian *historian;
    /* standby core only: folder of the file that lists for which alarms the leader has sent notifications. NULL: not stored */
    const char *folder;
    void (*notify)(void *arg);        /* called on the link's thread when core_link_collect() has new messages */
    void *notify_arg;
};

struct core_link;
/* Returns true if a URL is valid for a core: scheme, host and port, but no path. */
bool core_link_url_good(const char *url);
/* Starts the link. Returns NULL if the token cannot be read or the thread cannot be started (logged). Strings in `params` must
   outlive the link. */
struct core_link *core_link_start(const struct core_link_params *params);
/* Ends the thread. For forwarded actions still unanswered, core_link_collect() returns the answer that the outcome is unknown. */
void core_link_halt(struct core_link *link);
/* Ends the thread like core_link_halt() and frees the link. Sets *link to NULL; accepts a pointer to NULL. */
void core_link_stop(struct core_link **link);
bool core_link_is_up(struct core_link *link); /* Returns true if a core is sending readings now. Call from any thread. */

/* Returns the number of the connection over which a core sends readings; 0: there is none. Call from any thread. */
uint64_t core_link_session(struct core_link *link);

/* HTTP address of the core. */
struct core_peer {
    char url[320]; /* http or https URL of the core, without a path */
    /* authorization: value of the HTTP header `Authorization`, empty: not sent; ca_path: file of trusted certificates, NULL:
       the system's. Both stay valid as long as the link */
    const char *authorization, *ca_path;
};
/* Writes the address of the core that is sending readings to *out, for HTTP queries. Returns false if no core is. Call from any thread. */
bool core_link_peer(struct core_link *link, struct core_peer *out);
/* Like core_link_peer(), but returns the core that last accepted this node, or refused it because of its configuration. */
bool core_link_leader(struct core_link *link, struct core_peer *out);

struct core_act {
    uint64_t client;      /* id of this daemon's client that receives the core's answer */
    const char *from;     /* IP address of the user */
    const char *token;    /* token that the user presented to this renderer; the core verifies it. NULL: none */
    const char *id_token; /* ID token of a user who signed in at this renderer; the core verifies it. NULL: none */
    const char *text;     /* the client's message, JSON */
};
/* Sends a user's action to the core. Returns false, with nothing sent, if no core is connected or too many actions are
   unanswered. Call from any thread. */
bool core_link_act(struct core_link *link, const struct core_act *act);

/* Sends a JSON message that needs no answer. Returns false if no core is connected. Call from any thread. */
bool core_link_tell(struct core_link *link, const char *text);
/* Tells the leading core why this standby cannot get the core's files. Does nothing if no leading core is connected. Call from
   any thread. */
void core_link_report_files(struct core_link *link, const char *why);

/* A message from the core, to be handled by the event loop. */
struct core_arrival {
    struct core_arrival *next;
    uint64_t client; /* id of the client that receives this answer; 0: no answer, but a message `core`, `lists`, `reloading` or `refused` */
    char *text;
};
/* Returns the list of messages that have arrived since the last call, in order; free each with core_arrival_free(). */
struct core_arrival *core_link_collect(struct core_link *link);
void core_arrival_free(struct core_arrival *arrival);

#endif
