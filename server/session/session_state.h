/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state of one client's session, in parts by concern. The loop reads it; only functions of session.h change it. Thread: the loop. */
#ifndef SESSION_SESSION_STATE_H
#define SESSION_SESSION_STATE_H
#include "access/login_throttle.h"
#include "access/tokens.h"
#include "message/message.h"
#include "placing/tag_file.h"
#include "service/encoded_frame.h"
#include "service/pick_queue.h"
#include "session/pacing/admission.h"
#include "session/pacing/codec_choice.h"
#include "session/pacing/pacer.h"
#include "session/tiles/tile_layout.h"
#include "value/snapshot_cache.h"

enum { SESSION_MAX_REPLIES = 64 };

/* Who the client is, as far as `hello` has told. */
struct session_identity {
    uint64_t number; /* by which other clients name this session; random; a resumed session keeps the number it had */
    enum role role;
    uint8_t address[16];                  /* of the client, as in struct address_usage */
    char from[64];                        /* likewise, as text; "": not known */
    enum login login;                     /* the verdict on the token in hello */
    struct token_holder holder;           /* of that token; role ROLE_NOBODY: no token was given, or none was accepted */
    char token[TOKEN_MAX_CHARS + 1];      /* of a client of a renderer, for its core; "": none, or it is not handed on */
    char through[192];                    /* at a core: the node and the token that handed the message on; "": nobody did */
    char resume_secret[RESUME_CHARS + 1]; /* lets the client take its view up again over another connection */
    int64_t active_ns;                    /* monotonic: when somebody was last at the page; 0: not since it came */
    bool tokens;                          /* the client takes its view as a token whenever it changed */
    struct view token_view;               /* as last told in one */
    int64_t token_ns;                     /* monotonic: when that was */
    bool resumed;                         /* this session took up another's view, as `welcome` says */
    bool returned;                        /* likewise, and its followers have yet to be moved here */
};

/* Who connected. */
struct session_client {
    uint64_t number; /* as in struct session_identity */
    const uint8_t *address;
    const char *from; /* the same as text */
    enum role role;
    const struct token_holder *holder;
    const char *token; /* that the holder gave; "": none */
    struct address_share *share;
};

/* Why the connection is to be closed once the texts owed have been sent. */
struct session_close {
    int code;         /* WebSocket close code; 0: it stays open */
    const char *text; /* static */
};

/* The pixels that the session's view takes of the server's limits (session_admission.c). */
struct session_room {
    struct address_share *share; /* of the client's address; NULL: none */
    int64_t pixels;              /* counted in the admission's totals; 0: given back while the page was hidden */
    int64_t hidden_ns, shown_ns; /* when the page was last hidden; when it was last shown again, 0: never */
};

/* Which codec frames are encoded with. */
struct session_codec {
    struct codec_list list; /* what the client decodes */
    enum wire_codec current;
    struct codec_choice choice; /* where the server may choose */
    enum signed_frames signed_frames;
    bool unsigned_said; /* the client was told why its frames are not signed, since one was */
};

/* Why the next frame is wanted, and how refined the view is shown (session_frames.c). */
struct frame_demand {
    bool input, data, any;          /* the view changed; a reading changed; a frame is due even if it shows the same, and stands alone */
    int64_t input_ns;               /* newest change of the view */
    int64_t data_ns;                /* oldest change of a reading that no frame was requested for */
    int64_t preview_ns, refined_ns; /* when the newest frame of each tier was requested */
    enum { REFINED_NOT, REFINED_DRAFT, REFINED_FULL } refined; /* the best refined frame requested of the view as it is */
    bool refining; /* of what was requested and is not there yet, one is drawn between the frames of others, and may take a minute */
    double refined_bytes;                                      /* size of the last frame of full quality; 0: none was acknowledged */
    bool starting; /* the first frame waits until session_begin tells the bandwidth, for a second at most */
    int64_t starting_ns;
    bool failure_said; /* the client was told that the view as it is cannot be drawn */
    int64_t failed_ns; /* when the newest frame that there was no memory for was requested; 0: none */
};

/* Frames on their way to the client (session_frames.c). */
struct frame_delivery {
    struct pacer pacer;
    uint64_t newest_number;          /* of the frames that were received from the render service */
    struct encoded_frame *ready;     /* to be sent next, oldest first: a frame that stands alone replaces all before it */
    bool measured;                   /* pacer.acked is new (session_take_shown) */
    int steps[QUALITY_LADDER_STEPS]; /* how many who see this view, itself too, are at each step of the quality ladder */
    int common_step;                 /* the step that they share; negative: each its own */
};

/* What a client asked about following, by numbers of sessions. The loop finds those. */
struct follow_request {
    bool returned;   /* it took up another's view: whose followers are to follow it again */
    uint64_t heir;   /* who is to have the lead; 0: it stays */
    bool asked;      /* to follow `wanted` */
    uint64_t wanted; /* 0: nobody */
};

/* Who is shown whose view (session_follow.c). */
struct session_following {
    struct session *leader;   /* whose view is shown; NULL: its own. Kept right by the loop */
    bool asked;               /* the client asked to follow `wanted` */
    uint64_t wanted;          /* a session's number; 0: nobody */
    uint64_t left;            /* number of the leader who has gone and whose last view is shown; 0: none */
    struct view own_view;     /* its own view meanwhile */
    uint64_t heir_wanted;     /* who is to have the lead, as asked; 0: it stays */
    bool followers_changed;   /* the list of its followers is to be sent again */
    int64_t followers_ns;     /* when it was last made */
    char *followers_text;     /* that text, to be sent; NULL: none */
    uint32_t told_params_seq; /* of the leader's view, as the client was last told */
    int told_size_px[2];
};

/* Where in time the session is (session_time.c). What it shows is view.at_us and `historical`. */
struct travel {
    const struct historical_snapshot *historical; /* a reference; NULL: readings of now are shown */
    int64_t wanted_us;                            /* the instant that it moves to; 0: it is there */
    bool asked;                                   /* that is being read */
    bool first;                                   /* nothing is drawn until it is there: the session began at an instant */
    double speed;                                 /* of play, seconds in a second; 0: stands */
    int64_t from_us, from_ns;                     /* play was at from_us when the monotonic clock was at from_ns */
    int64_t stepped_ns;
};

/* Texts that the client has yet to be sent (session_texts.c). */
struct owed_texts {
    bool welcome, params, following, tags_all, tags, status, time, loop_checks; /* loop_checks: all of them */
    uint32_t params_seq;                                                        /* to be answered by `params` */
    int64_t tags_ns;                                                            /* when tags were last sent */
    uint32_t *tag_changes;                                                      /* reading.changes as last sent, by tag */
    bool alarms_sent;                                                           /* at least once */
    uint64_t alarms_number;                                                     /* of the last change of alarms that was sent */
    uint64_t views_sent, notes_sent, walls_sent, pointers_sent; /* likewise of views with names, notes, what desks sent, pointers */
    int64_t notes_at_us;                                                        /* the instant whose notes were sent; 0: now */
    uint64_t loop_checks_sent;                                                  /* number of the newest loop check that was sent */
    int64_t told_at_us;                                                         /* the instant that is shown, as last told; 0: now */
    bool told_beginning;                                                        /* the last `time` said where recorded history begins */
    char *replies[SESSION_MAX_REPLIES];                                         /* answers, oldest first */
    int reply_count;
};

/* Sensors that an engineer moves on trial (session_place.c). */
struct session_placement {
    struct place_set *set; /* of this session; NULL: nothing was moved */
    uint32_t seq;          /* of the newest `place` */
    struct tag_save *save; /* a tag list that is to be put in force (session_take_save) */
};

struct session_pick { /* a question about a pixel */
    bool pending;     /* `query` has yet to be asked */
    struct pick_query query;
};

/* A tile of one picture over many displays (tiles/tile_sync.c). */
enum { TILE_HELD = 8 };
struct session_tile {
    struct wall_place place;   /* display 0: it is none */
    struct tile_layout layout; /* by the size of its own display; that of who leads counts */
    struct tile_held {
        uint64_t picture; /* of the wall */
        uint32_t seq;     /* of the frame of this session that shows it */
    } held[TILE_HELD];    /* sent and not presented, oldest first */
    int held_count;
    bool moved;         /* since a picture was asked for: it is to be sent though nothing in it changed */
    uint64_t unchanged; /* the picture that is the same as the frame that is awaited; 0: none */
    uint32_t presented_seq;
    int64_t made_ns;       /* how long the server takes for a preview from when it is asked for, smoothed; 0: not known */
    int64_t late_us;       /* since when it is left out, UTC; 0: it is not */
    int64_t out_ns, in_ns; /* for how long it is left out; when it may come in again, or came */
    char *told;            /* the last `tiles`; NULL: none */
};

struct message_rate {
    int64_t begin_ns; /* of the second that is counted */
    int count;
    bool exceeded; /* the loop reads nothing more until that second is over */
};

struct session_stats { /* for the log and the counters */
    int64_t messages, errors, dropped;
};

/* What a narrowed token is good for (session_scope.c). */
struct session_scope {
    char named[NAMED_VIEW_ID_BYTES]; /* the view of the plant file that is shown; "": none of them */
    bool *tags;                      /* of a paired display without pictures: those that it shows; NULL: all */
};

struct session {
    uint64_t id; /* within this process */
    const struct session_context *context;
    struct session_identity identity;
    int64_t opened_ns;
    bool hello, hidden; /* hello was accepted; the client's page is not visible */
    double pixel_ratio; /* device pixels per pixel of the page */
    struct view view;   /* its own */
    struct session_close close;
    struct session_room room;
    struct session_codec codec;
    struct frame_demand demand;
    struct frame_delivery delivery;
    struct session_following following;
    struct travel travel;
    struct owed_texts owed;
    struct kept_answer *kept; /* answers that wait for the disk, oldest first (session_kept.c) */
    int kept_count;
    struct session_placement placement;
    struct session_pick pick;
    struct message_rate rate;
    struct session_stats stats;
    struct session_scope scope;
    struct wall_place display; /* that it is; display 0: none */
    struct session_tile tile;
    int64_t heard_ns;          /* when the client last said anything */
    int64_t settled_ns;        /* the last time at which nothing was owed to it */
};

/* Returns whether it has no token and is let in to look only: it gets frames, and no readings, tags or names of people. */
static inline bool session_is_open(const struct session *session)
{
    return session->identity.role == ROLE_OPEN;
}

#endif
