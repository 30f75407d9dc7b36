/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One client: its view, what it is owed, what it may have. Pure: no socket, no clock, no GL; time is handed in. Thread: the loop. */
#ifndef SESSION_SESSION_H
#define SESSION_SESSION_H
#include "base/text.h"
#include "access/login_throttle.h"
#include "message/message.h"
#include "service/pick_queue.h"
#include "service/encoded_frame.h"
#include "session/admission.h"
#include "session/codec_choice.h"
#include "session/pacer.h"
#include "session/resume.h"
#include "access/tokens.h"
#include "placing/tag_file.h"
#include "scene/scene.h"
#include "value/snapshot_cache.h"

enum { SESSION_MAX_REPLIES = 64 };
#define SESSION_MAX_INPUT_BYTES (1024 * 1024) /* beyond that the connection is closed */

/* What all sessions look at. Filled by the loop; a session changes only what is said so. */
struct session_context {
    const struct plant *plant;
    const struct scene *scene;
    const struct snapshot *snapshot;
    struct baselines *baselines;
    struct snapshot_cache *snapshot_cache; /* NULL: nothing is recorded, nobody can travel */
    int64_t history_first_us;              /* where what is recorded begins; 0: nothing is there yet */
    int64_t changed_ns;                    /* monotonic: the snapshot in which readings were seen to change last */
    struct alarm_service *alarm_service;   /* NULL: there are none */
    struct alarm_text_cache *alarms_said;  /* NULL: every text is made anew */
    struct placing *placing;               /* NULL: nothing can be placed */
    const char *tag_list;                  /* the text in force; NULL: it was not read */
    bool saving;                           /* somebody's list is being put in force */
    struct loop_checks *loop_checks;       /* NULL: nothing can be proven */
    const bool *links_up;                  /* by source index */
    bool live;                             /* values are coming in */
    bool clock_is_set;                     /* the wall clock is kept right by something */
    int64_t moving_until_ns;               /* somebody moves; a refined picture of another would make it stutter */
    bool loaded;                           /* refined pictures for all, whenever a reading changes, are more than can be drawn */
    unsigned codecs;                       /* a bit, 1 << enum wire_codec, for each that we have; 0: JPEG and PNG */
    double cpu_used;                       /* share of all processors of the machine, 0..1 */
    const char *version;
    const struct quotas *quotas;
    const struct tokens *tokens;      /* NULL: there are none */
    struct login_throttle *logins;    /* changed by hello; NULL: nobody counts wrong tokens */
    struct resumes *resumes;          /* changed by hello */
    struct admission *admission;      /* its pixels are changed by hello and resize */
    struct tag_text_cache *tags_said; /* NULL: every text is made anew */
    char **lists_said;                /* the part of welcome that all share, and that of those who only look on; NULL: likewise */
};

/* Where in time a session is. What it shows is view.at_us, and moment. */
struct travel {
    const struct historical_snapshot *historical; /* held; NULL: it shows now */
    int64_t wanted_us;                            /* the instant that it goes to; 0: it is there */
    bool asked;                                   /* it is being read */
    bool first;                                   /* nothing is drawn before it is there: it never looked at now */
    double speed;                                 /* of play; 0: stands */
    int64_t from_us, from_ns;                     /* play was at from_us when the monotonic clock said from_ns */
    int64_t stepped_ns;
};

struct session {
    uint64_t id;
    uint64_t called; /* its number for other clients: nobody comes by it by counting; that of the one it resumed, if any */
    const struct session_context *world;
    enum role role;
    uint8_t address[16];        /* of the client, as in struct address_usage */
    enum login login;           /* what became of the token in hello */
    struct token_holder holder; /* of whose token it is; nobody's: it needed none, or has yet to say it */
    int64_t opened_ns;
    bool hello, hidden;
    bool resumed;                  /* welcome says so */
    char resume[RESUME_CHARS + 1]; /* for its return */
    double pixel_ratio;
    struct address_share *share; /* of its address; NULL: of none. The hub's, and so is joining and leaving it */
    int64_t pixels;              /* as counted in world->admission, and there; 0: given back while it was hidden */
    int64_t hidden_ns;           /* since when it is, or is not */
    int close_code;              /* 0: stays; else the connection is to be closed once what is owed in words has gone */
    const char *close_text;      /* static */
    struct codec_list codecs;    /* what it decodes */
    enum wire_codec codec;       /* in use */
    struct codec_choice choice;  /* where the server may choose */
    struct view view;

    bool input_pending, data_pending, always_pending; /* why a picture is wanted */
    int64_t input_ns, data_ns;                        /* the newest input; the oldest change of a reading that is not yet asked for */
    int64_t moved_ns;                                 /* when the newest picture of the moving tier was asked for */
    int64_t refined_ns;                               /* when the newest of the still tier was */
    enum { REFINED_NOT, REFINED_DRAFT, REFINED_FULL } refined; /* how the view as it is has been asked for in the still tier */
    double still_bytes;                                        /* of the last picture of full quality; 0: none was acknowledged */
    struct pacer pacer;
    bool starting; /* the first picture waits for session_begin, a moment at most */
    int64_t starting_ns;
    uint64_t newest_number;      /* of the pictures that came */
    struct encoded_frame *ready; /* next to be sent, oldest first: newest wins, but for what only changes the one before */
    bool measured;               /* pacer.acked is new */

    bool failure_said; /* of the view as it is */
    int64_t failed_ns; /* when the newest picture that there was no memory for was asked for; 0: none */

    struct session *leader; /* whose view it is shown; NULL: its own. The hub keeps it right */
    bool follow_asked;
    uint64_t follow;                 /* whom; 0: nobody */
    bool returned;                   /* it has just resumed another: those who followed that one come along. The hub takes it */
    uint64_t left;                   /* `called` of its leader, who has gone and whose last view it is shown; 0: none */
    struct view beneath;             /* its own view meanwhile */
    uint64_t lead;                   /* who is to have the lead; 0: it stays. Asked for, as follow is */
    bool followers_changed;          /* they are to be said, in follow_tell */
    int64_t followers_ns;            /* when they were */
    char *followers;                 /* owed: the text that says who they are; NULL: none */
    int steps[QUALITY_LADDER_STEPS]; /* of those who see its view, itself too: how many are where */
    int common_step;                 /* of the ladder: of all who see the same; negative: its own */
    uint32_t leader_params_seq;      /* as last told; so is its size */
    int leader_size_px[2];

    struct travel travel;
    int64_t told_at_us; /* of what is shown, as the client was last told */

    bool owes_welcome, owes_params, owes_following, owes_tags_all, owes_tags, owes_status, owes_time;
    bool told_beginning;                     /* of what is recorded: in the last time that was told */
    uint32_t params_seq;                     /* to be answered */
    int64_t tags_ns;                         /* when values were last sent */
    uint32_t *tag_changes;                   /* reading.changes as last sent, by tag */
    uint64_t alarms_number;                  /* of the last change that was said */
    bool alarms_said;                        /* at least once */
    struct place_set *places;                /* of its own; NULL: it never placed anything */
    uint32_t place_seq;                      /* of the newest `place` */
    struct tag_save *save;                   /* it wants this list in force; the hub takes it */
    uint64_t loop_checks_said;               /* number of the newest loop check that was said */
    bool owes_loop_checks;                   /* all of them */
    bool pick_pending;
    struct pick_query pick;             /* to be asked */
    char *replies[SESSION_MAX_REPLIES]; /* pongs and errors, oldest first */
    int reply_count;

    int64_t rate_begin_ns;
    int rate_count;
    bool too_fast;                     /* read nothing more until session_tick */
    int64_t messages, errors, dropped; /* for the log and the counters */
};

struct session *session_create(const struct session_context *world, uint64_t id, int64_t now_ns);
void session_destroy(struct session **session); /* &NULL is fine; leaves NULL */
/* Its connection is gone. keep: its view, for its return. */
void session_leave(struct session *session, bool keep, int64_t now_ns);
void session_close(struct session *session, int code, const char *text); /* the first reason stands; text is static */
void session_check_token(struct session *session, int64_t now_utc_ns);   /* the file of tokens was read again, or time went by */

/* The plant is loaded anew. First: what it looks at, by names (mem_free); it travels no more. Then, with the world as it is by now. */
char *session_carry(struct session *session);
void session_take_plant(struct session *session, const char *carried);
/* Before that: what it will look at in such a world, now. */
void session_view_in(const struct session *session, const struct session_context *world, struct view *out);

/* One text message. Bad ones are answered with an error and change nothing. */
void session_on_message(struct session *session, const char *text, size_t count, int64_t now_ns, int64_t now_utc_ns);
void session_on_oversize(struct session *session, size_t count, int64_t now_ns);  /* a message too long to be kept */
void session_on_tick(struct session *session, int64_t now_ns);                    /* every 100 ms or so */
void session_on_data(struct session *session, int64_t data_ns);                   /* a reading changed: then */
void session_too_fast(struct session *session, int64_t count, const char *whose); /* reads nothing until this second is over */
/* Takes the picture over. */
void session_on_frame(struct session *session, struct encoded_frame *picture);

/* True: *wish is what to ask the render thread for, now. If it takes the wish, session_requested says whether as one more, or in place
   of one that was not begun. */
bool session_next_request(const struct session *session, int64_t now_ns, struct frame_request *wish);
void session_requested(struct session *session, const struct frame_request *wish, bool replaced);

/* True: *order is what to ask about a pixel, now. */
bool session_next_pick(struct session *session, struct pick_query *order);
void session_on_pick(struct session *session, const struct pick_answer *answer);

/* Anyone may look on: it gets pictures, and nothing that tells readings, tags or people. */
static inline bool session_is_open(const struct session *session)
{
    return session->role == ROLE_OPEN;
}

const struct view *session_view(const struct session *session);         /* what it is shown: its own, or its leader's */
const struct snapshot *session_snapshot(const struct session *session); /* the readings that it is shown: of now, or of an instant */
/* True: the instant that is to be read for it, now. Play goes on, and may end in the present. */
bool session_wants_historical_snapshot(struct session *session, int64_t now_ns, int64_t now_utc_ns, int64_t *at_us);
void session_on_historical_snapshot(struct session *session, int64_t at_us, bool good, int64_t now_ns); /* it was read, or could not be */
/* Answers session->follow_asked: leader NULL: from now on nobody's; session_follow_nobody: there is none such. */
void session_follow(struct session *session, struct session *leader, int64_t now_ns);
void session_follow_nobody(struct session *session);
/* Its leader goes, for good or for a moment: it is shown the last view of that one until it follows another, or nobody. */
void session_leader_gone(struct session *session, int64_t now_ns);
/* Likewise session->lead: from now on the heir shows what the session showed, at its own size, until it says otherwise. */
void session_inherit(struct session *heir, const struct session *session);
void session_lead_nobody(struct session *session); /* that one does not follow it */
void session_say_followers(struct session *session, const uint64_t *sessions, size_t count, int64_t now_ns);
void session_on_leader(struct session *session, int64_t now_ns); /* the leader's view changed */

/* session_place.c: distances of its sensors came in; gaps were found. */
void session_on_placed(struct session *session, int64_t now_ns);
void session_on_gaps(struct session *session, const struct sensor_coverage_answer *answer);
void session_say(struct session *session, const char *text); /* what came of something that it asked for */

/* The next text message to send, if any is due: into `out`. Markers of a picture are session_markers. */
bool session_next_text(struct session *session, int64_t now_ns, int64_t now_utc_ns, struct text *out);
bool session_has_text(const struct session *session, int64_t now_ns);
/* The next picture, if one waits: the caller owns it, *seq is its number. Then session_wrote for each part of it. */
struct encoded_frame *session_next_frame(struct session *session, int64_t now_ns, uint32_t *seq);
void session_wrote(struct session *session, bool all, int64_t now_ns);
/* The picture under way is not worth sending on: it is refined, and what it shows has changed since, or nothing moves at all. */
bool session_gives_up(const struct session *session, const struct encoded_frame *sending, size_t bytes_left, int64_t now_ns);
void session_gave_up(struct session *session); /* it was cut short */
/* What was said at first, so many bytes, was there after so long: the first picture can be made as large as the network takes. */
void session_begin(struct session *session, size_t bytes, int64_t took_ns);
void session_on_pong(struct session *session, int64_t rtt_ns, int64_t now_ns);
enum pacer_state session_state(const struct session *session, int64_t now_ns);

#endif
