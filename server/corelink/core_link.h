/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A renderer's link to its core, on a thread of its own: brings readings, links and alarms to the store and the alarm service, and sends
   what operators do. When the core is lost, or was silent for CORE_SILENT_NS, all readings are Bad at once. It is tried again for ever. */
#ifndef CORELINK_CORE_LINK_H
#define CORELINK_CORE_LINK_H
#include "alarm/alarm_service.h"
#include "base/log/log.h"
#include "base/metrics/counters.h"
#include "corelink/lease_keeper.h"
#include "history/historian.h"
#include "value/store.h"

#define CORE_SILENT_NS (2 * INT64_C(1000000000))
enum { CORE_URLS = 4, CORE_ACTS = 256 /* that wait for their answers */ };

struct core_link_params {
    struct log *log;
    struct counters *counters;
    const struct plant *plant;
    struct store *store;
    struct alarm_service *alarm_service; /* which mirrors; all three outlive the link */
    const char *urls[CORE_URLS];         /* ws://HOST:PORT or wss://; tried in turn: one of them is the core */
    int url_count;
    const char *token_path, *ca_path;    /* file of the token; certificates that are trusted. NULL: none; the system's */
    const char *version, *node;          /* of this program; this renderer's name, for the core's log */
    struct lease_keeper *keeper;         /* of a core that stands by: it promises what the leader asks. NULL: of a renderer */
    struct historian *historian;         /* of such a core: it records what the leader does. NULL: nothing is recorded */
    const char *folder;                  /* of such a core: where what its notifier is to know is kept. NULL: nowhere */
    void (*notify)(void *arg);           /* called by the thread when there is something to collect */
    void *notify_arg;
};

struct core_link;
/* Returns whether that is the URL of a core: scheme, host, port, and no path. */
bool core_link_url_good(const char *url);
/* Returns NULL if the token cannot be read or there is no thread (logged). Strings of params are used while the link lives. */
struct core_link *core_link_start(const struct core_link_params *params);
/* Ends the thread. What waits for an answer gets one that nothing is known of it: core_link_collect still has it. */
void core_link_halt(struct core_link *link);
void core_link_stop(struct core_link **link); /* likewise, and frees; &NULL is fine; leaves NULL */
bool core_link_is_up(struct core_link *link); /* returns whether readings come. Any thread */

/* Where else the core answers, for HTTP. */
struct core_peer {
    char url[320];                            /* http or https, without a path */
    const char *authorization, *ca_path; /* the value of that header, "": none; as of params. Both live as long as the link */
};
/* Returns which core readings come from now. False: from none. Any thread */
bool core_link_peer(struct core_link *link, struct core_peer *out);

struct core_act {
    uint64_t client;          /* whose answer it will be */
    const char *from;         /* the person's address */
    const char *token;        /* token that the person gave here; the core verifies it. NULL: none */
    const char *id_token;     /* ID token of a person who is signed in here. NULL: none */
    const char *text;         /* the client's message, JSON */
};
/* Sends what somebody does to the core. Returns false if there is no core now, or too much waits: nothing was sent. Any thread. */
bool core_link_act(struct core_link *link, const struct core_act *act);

/* Sends a message that has no answer, JSON. Returns false if there is no core now. Any thread. */
bool core_link_tell(struct core_link *link, const char *text);

/* What came for the loop. */
struct core_arrival {
    struct core_arrival *next;
    uint64_t client; /* whose answer it is; 0: it is `core` or `lists`, of the core itself */
    char *text;
};
/* Returns what came since the last call, in order; each for core_arrival_free. */
struct core_arrival *core_link_collect(struct core_link *link);
void core_arrival_free(struct core_arrival *arrival);

#endif
