/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State that all sessions share: the plant, its services and the server's limits. Call only in the event loop. */
#ifndef SESSION_SESSION_CONTEXT_H
#define SESSION_SESSION_CONTEXT_H
#include <jansson.h>

#include "access/openid/openid.h"
#include "audit/audit.h"
#include "base/files/file_writer.h"
#include "base/system/clock_state.h"
#include "scene/scene.h"
#include "session/plant_services.h"
#include "session/session_state.h"

struct view_token_keys;

enum audience_lists { LISTS_NAMED, LISTS_OPEN, LISTS_VIEWS, LISTS };

/* State shared by all sessions about answers that wait until their actions are on disk (session_kept.c). */
struct kept_answers {
    bool waiting;         /* true: an answer waits for the disk, so session_settle() and session_settle_gone() must be called soon */
    struct session *gone; /* sessions whose client has gone, kept until it is known whether their actions reached the disk */
};

/* The readings that sessions show, and the state of their sources and of the clock. */
struct session_readings {
    const struct snapshot *snapshot; /* the newest readings */
    int64_t history_first_us;        /* UTC microseconds at which recorded history begins; 0: nothing is recorded yet */
    /* monotonic time of the newest snapshot whose readings differ from those of the snapshot before */
    int64_t changed_ns;
    const bool *links_up;     /* by source: true: the data source is connected */
    bool live;                /* true: at least one data source is connected */
    struct clock_state clock; /* state of the wall clock: whether it is set, and its estimated error */
};

/* The ways in which clients prove their identity. */
struct session_sign_in {
    const struct tokens *tokens;           /* NULL: none are configured */
    struct openid *openid;                 /* service for signing in with OpenID Connect; NULL: off */
    int64_t lock_ns;                       /* monotonic duration without user activity after which the user must sign in again; 0: never */
    struct login_throttle *login_throttle; /* counter of wrong tokens in `hello` messages, by address; NULL: not counted */
    /* keys that sign view tokens, by which clients restore their view at another daemon; NULL: clients get no view tokens */
    const struct view_token_keys *token_keys;
};

/* On a renderer (daemon that draws for a core): its connection to the core. */
struct session_core {
    /* Forwards a session's message to the core, which answers later. Returns false if the core is not connected. NULL: this
       daemon is not a renderer and acts on messages itself. */
    bool (*hand_on)(void *arg, const struct session *session, const char *text);
    void *hand_on_arg;
    bool up; /* true: the core sends readings */
};

/* The load of the daemon. */
struct session_load {
    /* monotonic time until which a session's camera counts as moving; refined frames of other sessions wait until then, because
       they would make that session's pictures stutter */
    int64_t moving_until_ns;
    /* true: drawing is too slow to send all sessions a refined (detailed) frame after each change of readings */
    bool overloaded;
    double cpu_used; /* busy share of all processors of the machine, 0..1 */
};

/* The writers that record users' actions. */
struct session_records {
    struct audit *audit; /* writer of the audit trail; NULL: nothing is recorded */
    /* background writer of views, notes, walls, pairings and loop checks; NULL: these are written at once */
    struct file_writer *file_writer;
    /* list of answers that wait for the disk, shared by all sessions; NULL: session_destroy() drops such answers */
    struct kept_answers *kept_answers;
    bool saving; /* true: a user's new tag list is saved, and the reload that activates it is still running */
};

/* Texts that are the same for many sessions. */
struct session_text_caches {
    struct alarm_text_cache *alarm_texts; /* NULL: no caching */
    struct tag_text_cache *tag_texts;     /* `tags` messages; NULL: no caching */
    /* By enum audience_lists: JSON lists of groups, assets and so on for `welcome`. Clients with names, open viewers (without a
       token) and tokens narrowed to views get different lists. NULL: no caching. */
    char **lists_said;
};

/* Kinds of entries that the daemon records in files. UNRECORDED_LISTS: views, notes, short links, orders to walls and paired displays. */
enum unrecorded { UNRECORDED_READINGS, UNRECORDED_ALARMS, UNRECORDED_ACTIONS, UNRECORDED_LISTS, UNRECORDED_COUNT };

/* The event loop sets the members. Sessions change only members whose comments say so. */
struct session_context {
    const struct plant *plant;
    /* sessions change only its named views, short links, baselines, notes, walls, pairings and loop checks */
    const struct plant_services *services;
    struct session_readings readings;
    struct session_sign_in sign_in;
    struct session_core core;
    struct session_load load;
    struct session_records records;
    struct session_text_caches caches;
    /* on a core that leads another one: what engineers learn about the standby (`standby` in the message `status`); NULL: there
       is no pair, or this core does not lead */
    json_t *standby;
    unsigned unrecorded;     /* bit mask of what is not recorded, because a file cannot be used (1 << enum unrecorded) */
    bool imports;            /* true: engineers may import plants */
    const char *signing_key; /* id of the key that signs pictures; NULL: pictures are not signed */
    unsigned codecs;         /* bit mask of the codecs that work here (1 << enum wire_codec); 0: JPEG and PNG */
    const char *node;        /* this daemon's name behind a load balancer; NULL: it runs alone */
    const char *version;
    const struct quotas *quotas;
    struct resumes *resumes;     /* views of lost connections, which returning clients can resume; the message hello changes them */
    struct admission *admission; /* shared limit on the pixels of all sessions; hello, resize and visible change its counts */
};

#endif
