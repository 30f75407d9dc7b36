/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state of one client's session, grouped by concern. The event loop reads it; only functions of session.h change it. Call
   only in the event loop. */
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

/* Identity of the client: members from its connection and from its message `hello`. */
struct session_identity {
    uint64_t number; /* random number that identifies this session to other clients; a resumed session keeps its number */
    enum role role;
    uint8_t address[16];        /* address of the client; an IPv4 address has the form ::ffff:a.b.c.d */
    char from[64];              /* address of the client as text; empty: not known */
    enum login login;           /* result of checking the token in `hello`, the client's first message */
    struct token_holder holder; /* holder of the token; role ROLE_NOBODY: no token was given, or it was not accepted */
    /* on a renderer (daemon that draws for a core): the client's token, for the core; "": none, or not forwarded */
    char token[TOKEN_MAX_CHARS + 1];
    /* on a core (daemon that reads the devices): names of the renderer and of its token that forwarded the message; "": not forwarded */
    char through[192];
    char resume_secret[RESUME_CHARS + 1]; /* secret with which the client can continue with this view over another connection */
    int64_t active_ns; /* monotonic time of the user's last activity at the page; 0: none since the page connected */
    bool tokens;       /* true: the client wants its view as a signed view token after each change */
    struct view token_view; /* the view in the last view token that was sent */
    int64_t token_ns;       /* monotonic time when the last view token was sent */
    bool resumed;           /* true: this session resumed another session's view, as `welcome` tells the client */
    bool returned;          /* true until the followers of the resumed session have been moved to this one */
};

/* The client at the other end of a new connection, for session_introduce(). */
struct session_client {
    uint64_t number; /* number by which other clients refer to the session (struct session_identity) */
    const uint8_t *address;
    const char *from; /* address of the client as text */
    enum role role;
    const struct token_holder *holder;
    const char *token; /* access token of the client; empty: none */
    struct address_share *share;
};

/* Reason and code for closing the connection once all queued texts are sent. */
struct session_close {
    int code;         /* close code for the WebSocket, sent once all queued texts are sent; 0: the connection stays open */
    const char *text; /* reason why the connection is closed; static text */
};

/* The pixels that the session's view takes from the admission budget (session_admission.c). */
struct session_room {
    struct address_share *share; /* use of the server by the client's address; NULL: the session has no address */
    int64_t pixels; /* the session's pixels in the admission totals; 0: none, for example while the page is hidden */
    /* hidden_ns: monotonic time when the page was last hidden; shown_ns: when it was last shown again; 0: never */
    int64_t hidden_ns, shown_ns;
};

/* The choice of the codec with which the session's frames are encoded. */
struct session_codec {
    struct codec_list list; /* codecs that the client decodes */
    enum wire_codec current;
    struct codec_choice choice; /* state of the automatic choice of the codec, if the client leaves the choice to the server */
    enum signed_frames signed_frames;
    bool unsigned_said; /* true: the client was told why its frames are unsigned; reset when a signed frame is sent */
};

/* Reasons to request the next frame, and the quality of the shown picture (session_frames.c). */
struct frame_demand {
    /* reasons why a frame is wanted. input: the view changed; data: a reading changed; any: a frame is required even if its
       content is the same, and must decode without earlier frames */
    bool input, data, any;
    int64_t input_ns;               /* monotonic time of the newest change of the view */
    int64_t data_ns;                /* monotonic time of the oldest changed reading for which no frame was requested */
    int64_t preview_ns, refined_ns; /* monotonic times when the newest preview, and the newest refined (detailed) frame, was requested */
    /* quality of the best refined (detailed) frame that was requested for the present view */
    enum { REFINED_NOT, REFINED_DRAFT, REFINED_FULL } refined;
    /* true: a refined frame is requested and has not arrived; this may take a minute, because the render thread draws it
       between other sessions' frames */
    bool refining;
    double refined_bytes; /* size in bytes of the last frame of full quality; 0: none was acknowledged */
    bool starting;        /* true: the first frame waits, for a second at most, for session_begin(), which brings the measured bandwidth */
    int64_t starting_ns;
    bool failure_said; /* true: the client was told that the present view cannot be drawn */
    /* monotonic time of the newest frame request that brought the client no frame, because the frame was lost or memory was
       short; 0: none */
    int64_t failed_ns;
    /* true: a refined frame was lost on its way to the client. It must be drawn again, although the render service counts it as shown */
    bool lost;
};

/* Frames between the render service and the client (session_frames.c). */
struct frame_delivery {
    struct pacer pacer;
    uint64_t newest_number;          /* sequence number of the newest frame received from the render service */
    /* true: the newest frame received (newest_number) is a refined one, drawn in detail for a camera at rest */
    bool newest_refined;
    /* frames that are ready to be sent, oldest first. A frame that arrives and decodes without earlier frames replaces the
       whole list */
    struct encoded_frame *ready;
    bool measured;                   /* true: the client acknowledged frame pacer.acked, and session_take_shown() has not returned it yet */
    struct depth_grid *depth[2];     /* newest depth grids sent to the client, of a frame or of both halves of a split view; NULL: none */
    /* [step]: number of sessions, this one included, that show this view and for which the quality ladder
       (pacing/quality_ladder.h) chose this step */
    int steps[QUALITY_LADDER_STEPS];
    /* step of the quality ladder that all viewers of this view share, so that a frame is encoded once for all; negative: each
       viewer uses its own step */
    int common_step;
};

/* A client's requests about following, by session numbers. The event loop looks up the sessions. */
struct follow_request {
    bool returned;   /* true: the session resumed another session, whose former followers are to follow this one */
    /* number of the follower to which the client wants to hand the lead (others then follow that session's view); 0: the lead
       stays */
    uint64_t heir;
    bool asked;      /* true: the client requested to follow session `wanted`, or nobody */
    uint64_t wanted; /* number of the session that the client wants to follow; 0: nobody */
};

/* The leader and the followers of a session (session_follow.c). */
struct session_following {
    struct session *leader;   /* session whose view this session shows; NULL: its own view. The event loop keeps the pointer valid */
    bool asked;               /* true: the client requested to follow session `wanted`, or nobody */
    uint64_t wanted;          /* number of the session that the client requested to follow; 0: nobody */
    uint64_t left;            /* number of the leader who has gone but whose last view is still shown; 0: none */
    struct view own_view;     /* the session's own view while it follows a leader */
    /* number of the follower to which the client wants to hand the lead (others then follow that session's view); 0: the lead
       stays */
    uint64_t heir_wanted;
    bool followers_changed;   /* true: the list of followers changed and must be sent to the client */
    int64_t followers_ns;     /* monotonic time when the list of followers was last built */
    char *followers_text;     /* text that lists the followers, to be sent; NULL: none */
    /* sequence number (params_seq) of the leader's view parameters in the last message `following` to the client */
    uint32_t told_params_seq;
    int told_size_px[2];
};

/* The past instant that the session shows, and playback (session_time.c). The shown instant itself is view.at_us with the readings in
   `historical`. */
struct travel {
    /* readings of the shown instant (a reference); NULL: the session shows the present */
    const struct historical_snapshot *historical;
    int64_t wanted_us;        /* instant that the session is going to, UTC microseconds; 0: it has arrived */
    bool asked;               /* true: the readings of the instant wanted_us are being loaded */
    bool first;               /* true: the session began at a past instant; nothing is drawn until the readings are loaded */
    double speed;             /* playback speed in seconds of recorded history per second; 0: paused */
    int64_t from_us, from_ns; /* reference point of playback: at the monotonic time from_ns, the instant from_us was shown */
    int64_t stepped_ns;
};

/* Texts that are still to be sent to the client (session_texts.c). */
struct owed_texts {
    /* true: the text with that name must still be sent; loop_checks: the complete list of loop checks must be sent */
    bool welcome, params, following, tags_all, tags, status, time, loop_checks;
    uint32_t params_seq;    /* sequence number of the client's message that the next `params` message answers */
    int64_t tags_ns;        /* monotonic time when the last message with readings (`tags`) was sent */
    uint32_t *tag_changes;  /* by tag: change counter (reading.changes) of the reading that was last sent */
    bool alarms_sent;       /* true: at least one message `alarms` was sent; the first one lists all alarms that are not normal */
    uint64_t alarms_number; /* sequence number of the last change of alarms that was sent to the client */
    /* sequence numbers of the last changes sent to the client, one each for named views, notes, messages of desks to walls, and pointers */
    uint64_t views_sent, notes_sent, walls_sent, pointers_sent;
    int64_t notes_at_us;                /* instant for which notes were last sent, UTC microseconds; 0: the present */
    /* sequence number of the newest loop check (test of a tag with a value forced at its transmitter) that was sent to the
       client */
    uint64_t loop_checks_sent;
    int64_t told_at_us;                 /* instant of the last `time` message that the client was sent, UTC microseconds; 0: the present */
    bool told_beginning;                /* true: the last `time` message included the beginning of recorded history */
    char *replies[SESSION_MAX_REPLIES]; /* answers to the client's messages that are still to be sent, oldest first */
    int reply_count;
};

/* Sensors whose positions an engineer is trying out (session_place.c). */
struct session_placement {
    struct place_set *set; /* positions of the sensors that this session moved to try them out; NULL: none was moved */
    uint32_t seq;          /* sequence number of the newest `place` message of the client */
    struct tag_save *save; /* tag list with the engineer's changes, waiting to be saved (session_take_save); NULL: none */
};

struct session_pick { /* pick: a query for what is at a pixel */
    bool pending;     /* true: `query` was not sent to the render service yet */
    struct pick_query query;
};

/* One display's part of a picture that spans a wall of displays (tiles/tile_sync.h). */
enum { TILE_HELD = 8 };
struct session_tile {
    struct wall_place place; /* display whose part of the wall's picture this tile shows; display 0: the session is not a tile */
    /* layout of the wall's picture, from the size of this session's display; only the leading session's layout is used */
    struct tile_layout layout;
    struct tile_held {
        uint64_t picture; /* number that identifies one picture of the wall, the same for all displays that show its parts (tiles) */
        uint32_t seq;     /* sequence number of this session's frame that shows the picture */
    } held[TILE_HELD];    /* frames sent but not yet shown at the wall's common instant, oldest first */
    int held_count;
    /* true: the burn-in shift changed after the last picture was requested, so the next picture is sent even if its content is the same */
    bool moved;
    /* id of a wall's picture in which this tile looks the same as in a frame still on its way to the client; 0: none */
    uint64_t unchanged;
    uint32_t presented_seq;
    int64_t made_ns; /* smoothed time in nanoseconds from the request for a preview to the encoded frame; 0: not known */
    int64_t late_us; /* UTC microseconds when this display was dropped from the wall's picture because it was slow; 0: it takes part */
    /* out_ns: how long this tile (display with a part of a wall's picture) stays dropped. in_ns: monotonic; while the tile is
       dropped: the earliest time of its readmission; otherwise: the time of its last readmission */
    int64_t out_ns, in_ns;
    char *told; /* last message `tiles` (state of the wall's displays) sent to the client; NULL: none */
};

struct message_rate {
    int64_t begin_ns; /* monotonic start of the second for which messages are counted */
    int count;
    /* true: the client has reached the limit of messages in the counted second, so the event loop reads none until that second is over */
    bool exceeded;
};

struct session_stats { /* counts of messages and errors, for the log and the metrics */
    int64_t messages, errors, dropped;
};

/* Restrictions of a narrowed token, which allows only some views or one display (session_scope.c). */
struct session_scope {
    char named[NAMED_VIEW_ID_BYTES]; /* id of the shown view of the plant file; "": none */
    /* by tag: whether this paired display shows the tag; NULL: no restriction (the display shows pictures, or the session is no display) */
    bool *tags;
};

struct session {
    uint64_t id; /* id of the session, unique within this process */
    const struct session_context *context;
    struct session_identity identity;
    int64_t opened_ns;
    bool asks_depth;    /* true: the client's message `hello` asked for depth grids (coarse depth) with its frames */
    bool hello, hidden; /* hello: the client's hello was accepted; hidden: the client's page is not visible */
    double pixel_ratio; /* device pixels per CSS pixel on the client's screen */
    struct view view;   /* the session's own view */
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
    struct session *next_gone; /* next session in the list kept_answers.gone (sessions whose client has left) */
    struct session_placement placement;
    struct session_pick pick;
    struct message_rate rate;
    struct session_stats stats;
    struct session_scope scope;
    struct wall_place display; /* wall display that the client has introduced itself as; display 0: none */
    struct session_tile tile;
    int64_t heard_ns;   /* monotonic time when the last message from the client arrived */
    /* value of heard_ns when session_on_tick() last found that the client showed the newest picture (none was owed to it) */
    int64_t settled_ns;
};

/* Returns whether the session is an open viewer, without a token: it gets frames, but no readings, tags or names of people. */
static inline bool session_is_open(const struct session *session)
{
    return session->identity.role == ROLE_OPEN;
}

#endif
