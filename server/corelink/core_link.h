/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A renderer's link to its core, on a thread of its own. It passes readings, states of sources and alarms to the store and the alarm
   service, and sends the actions of operators to the core. When the core is lost, or silent for CORE_SILENT_NS, all readings become Bad
   immediately. The link reconnects forever. */
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
    struct plant_clock *clock;           /* set to the core's time */
    struct alarm_service *alarm_service; /* alarm service in mirror mode (it takes states from the core); plant, store and alarm service
                                            must outlive the link */
    const char *urls[CORE_URLS];         /* ws://HOST:PORT or wss://HOST:PORT of each core that may be the leader; tried one after the
                                            other */
    int url_count;
    const char *token_path, *ca_path; /* token_path: token file, NULL: none; ca_path: file of trusted certificates, NULL: the system's */
    const char *version, *node;       /* version of this program; name of this renderer for the core's log */
    struct lease_keeper *keeper;      /* standby core only: makes the lease promises that the leader requests. NULL: this node is a
                                         renderer */
    struct historian *historian;      /* standby core only: records the leader's samples. NULL: nothing is recorded */
    const char *folder;               /* standby core only: folder in which the state of the leader's notifier is stored. NULL: not
                                         stored */
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
void core_link_stop(struct core_link **link); /* Ends the thread like core_link_halt() and frees the link. &NULL is fine; leaves NULL. */
bool core_link_is_up(struct core_link *link); /* Returns true while a core sends readings. Thread: any. */

/* Returns the number of the connection over which a core sends readings; 0: none does. Thread: any. */
uint64_t core_link_session(struct core_link *link);

/* HTTP address of the core. */
struct core_peer {
    char url[320]; /* http or https URL of the core, without a path */
    /* authorization: value of the HTTP header `Authorization`, empty: none; ca_path: file of trusted certificates, NULL: the system's. Both
       are valid as long as the link */
    const char *authorization, *ca_path;
};
/* *out receives the core that sends readings now. Returns false if no core does. Thread: any. */
bool core_link_peer(struct core_link *link, struct core_peer *out);

struct core_act {
    uint64_t client;      /* id of the client that gets the answer */
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

/* A message from the core for the event loop. */
struct core_arrival {
    struct core_arrival *next;
    uint64_t client; /* id of the client that gets this answer; 0: no answer, but the core's own message `core`, `lists`,
                        `reloading` or `refused` */
    char *text;
};
/* Returns a list of the messages that arrived since the last call, in order; free each with core_arrival_free(). */
struct core_arrival *core_link_collect(struct core_link *link);
void core_arrival_free(struct core_arrival *arrival);

#endif
