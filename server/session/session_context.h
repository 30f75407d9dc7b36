/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What all sessions have in common. Thread: the loop. */
#ifndef SESSION_SESSION_CONTEXT_H
#define SESSION_SESSION_CONTEXT_H
#include "access/openid/openid.h"
#include "audit/audit.h"
#include "base/system/clock_state.h"
#include "scene/scene.h"
#include "session/session_state.h"

/* Set by the loop; sessions change only the members that say so. */
struct view_token_keys;

enum audience_lists { LISTS_NAMED, LISTS_OPEN, LISTS_VIEWS, LISTS };

struct session_context {
    const struct plant *plant;
    const struct scene *scene;
    const struct snapshot *snapshot; /* the newest readings */
    struct baselines *baselines;
    struct snapshot_cache *snapshot_cache; /* readings of past instants; NULL: nothing is recorded */
    int64_t history_first_us;              /* where recorded history begins; 0: nothing is recorded yet */
    int64_t changed_ns;                    /* monotonic: when a snapshot last differed from the one before */
    struct alarm_service *alarm_service;   /* NULL: no alarms */
    struct alarm_text_cache *alarm_texts;  /* NULL: each text is made anew */
    struct placing *placing;               /* NULL: sensors cannot be placed */
    const char *tag_list;                  /* the text in force; NULL: it could not be read */
    bool saving;                           /* a saved list is being put in force */
    struct loop_checks *loop_checks;       /* NULL: loops cannot be checked */
    struct named_views *named_views;       /* changed by save_view and remove_view */
    struct notes *notes;                   /* changed by note and remove_note */
    struct wall_remote *wall_remote;       /* changed by send_to_wall and point */
    struct pairings *pairings;             /* changed by pair and unpair */
    /* On a renderer: hands a message of a session on to the core, which answers later. Returns false if there is no core now. NULL: this
       daemon does it itself. */
    bool (*hand_on)(void *arg, const struct session *session, const char *text);
    void *hand_on_arg;
    bool core_up;                          /* likewise: readings come from the core */
    const struct view_token_keys *token_keys; /* NULL: views are not told as tokens */
    const bool *links_up;                  /* by source */
    bool imports;                          /* engineers may bring plants in */
    const char *signing_key;               /* the id of the key that signs pictures; NULL: none does */
    bool live;                             /* a source is connected */
    struct clock_state clock;              /* how right the wall clock is */
    int64_t moving_until_ns;               /* some camera moves until then; refined frames of others would make it stutter */
    bool overloaded;                       /* refined frames for all, at each change of readings, are more than can be drawn */
    unsigned codecs;                       /* a bit, 1 << enum wire_codec, for each that works here; 0: JPEG and PNG */
    double cpu_used;                       /* share of all processors of the machine, 0..1 */
    const char *node; /* this daemon's name among those that a load balancer stands before; NULL: it is alone */
    const char *version;
    const struct quotas *quotas;
    const struct tokens *tokens;           /* NULL: none are configured */
    struct openid *openid;                 /* NULL: nobody signs in */
    int64_t lock_ns;                       /* who was not at the page for so long has to say again who it is; 0: nobody has to */
    struct login_throttle *login_throttle; /* changed by hello; NULL: wrong tokens are not counted */
    struct audit *audit;                   /* NULL: nothing is recorded */
    bool *kept_answers;                    /* set where an answer waits for the disk: session_settle() is due soon; may be NULL */
    struct resumes *resumes;               /* changed by hello */
    struct admission *admission;           /* its pixels are changed by hello, resize and visible */
    struct tag_text_cache *tag_texts;      /* NULL: each text is made anew */
    /* Parts of `welcome` that sessions share, by enum audience_lists: for clients with names, for open viewers, for tokens narrowed to
       views. NULL: each text is made again. */
    char **lists_said;
};

#endif
