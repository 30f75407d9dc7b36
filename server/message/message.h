/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A client's message: its JSON text is parsed and checked, and becomes a struct. No other code parses clients' messages. Pure.
   Call from any thread. */
#ifndef MESSAGE_MESSAGE_H
#define MESSAGE_MESSAGE_H
#include <jansson.h>

#include "alarm/alarms.h"
#include "message/message_error.h"
#include "placing/assumed_places.h"
#include "placing/placing.h"
#include "protocol/wire.h"
#include "loopcheck/loop_checks.h"
#include "render/view.h"
#include "scene/framing.h"
#include "views/named_views.h"
#include "views/notes.h"
#include "views/wall_remote.h"

enum message_type {
    MESSAGE_HELLO,
    MESSAGE_CAMERA,
    MESSAGE_PARAMS,
    MESSAGE_RESIZE,
    MESSAGE_ACK,
    MESSAGE_VISIBLE,
    MESSAGE_PING,
    MESSAGE_FIT,
    MESSAGE_PICK,
    MESSAGE_KEY_FRAME,
    MESSAGE_CODECS,
    MESSAGE_FOLLOW,
    MESSAGE_LEAD,
    MESSAGE_ALARM,
    MESSAGE_TIME,
    MESSAGE_PLACE,
    MESSAGE_COVERAGE,
    MESSAGE_SAVE_TAGS,
    MESSAGE_ACCEPT_PLACES,
    MESSAGE_RESTORE_TAGS,
    MESSAGE_LOOP_CHECK,
    MESSAGE_SAVE_VIEW,
    MESSAGE_REMOVE_VIEW,
    MESSAGE_SHARE_VIEW,
    MESSAGE_NOTE,
    MESSAGE_REMOVE_NOTE,
    MESSAGE_DISPLAY,
    MESSAGE_SEND_TO_WALL,
    MESSAGE_POINT,
    MESSAGE_PAIR,
    MESSAGE_UNPAIR,
    MESSAGE_LOOK,
    MESSAGE_SIGN
};

/* frames of a session that the server must sign (SIGNED_REFINED: only refined frames, not previews of a moving picture) */
enum signed_frames { SIGNED_NONE, SIGNED_REFINED, SIGNED_ALL };

/* RESUME_CHARS: length of a resume token, by which a client continues its session after a lost connection. RESUME_MOST_CHARS:
   maximum length of a resume token that also contains the session's view */
enum { TOKEN_MAX_CHARS = 128, RESUME_CHARS = 32, RESUME_MOST_CHARS = 8191 };

enum params_given { /* bits of params_change.given, one for each possible member of a params message */
                    GIVEN_GROUP = 1 << 0,
                    GIVEN_INTERPOLATION = 1 << 1,
                    GIVEN_DISTANCE = 1 << 2,
                    GIVEN_FILL = 1 << 3,
                    GIVEN_STRENGTH = 1 << 4,
                    GIVEN_DECAY = 1 << 5,
                    GIVEN_POWER = 1 << 6,
                    GIVEN_RADIUS = 1 << 7,
                    GIVEN_REACH = 1 << 8,
                    GIVEN_COLORMAP = 1 << 9,
                    GIVEN_RAMP = 1 << 10,
                    GIVEN_RANGE = 1 << 11,
                    GIVEN_LOOK = 1 << 12,
                    GIVEN_LIGHT = 1 << 13,
                    GIVEN_SELECTED = 1 << 14,
                    GIVEN_SHOW = 1 << 15,
                    GIVEN_SENSOR = 1 << 16,
                    GIVEN_SENSORS = 1 << 17,
                    GIVEN_SCALE = 1 << 18,
                    GIVEN_BREAKS = 1 << 19,
                    GIVEN_ISOLINES = 1 << 20,
                    GIVEN_HIDDEN = 1 << 21,
                    GIVEN_ISOLATE = 1 << 22,
                    GIVEN_GHOST = 1 << 23,
                    GIVEN_CLIP = 1 << 24,
                    GIVEN_ENVIRONMENT = 1 << 25,
                    GIVEN_BACKDROP = 1 << 26,
                    GIVEN_STRIP = 1 << 27,
                    GIVEN_ARROWS = 1 << 28,
                    GIVEN_LANGUAGE = 1 << 29,
};

enum baseline_change { BASELINE_STAYS, BASELINE_NONE, BASELINE_NAMED, BASELINE_NOW, BASELINE_SET, BASELINE_REMOVE };

struct params_change {
    uint32_t seq;
    unsigned given;            /* bit mask of the members present in the message (enum params_given) */
    /* This and all following members are new values of parameters, each valid only if its bit is set in `given`. */
    struct field_params field;
    int colormap;
    double ramp_interval;
    struct color_scale color_scale;
    double isoline_step; /* difference between adjacent isolines, in the unit of the values; 0: color_scale lists the isolines */
    bool breaks_of_group, breaks_of_limits;
    /* true: the message had `range: null`: the colour scale gets the range that the plant file states for the sensor group */
    bool range_of_group;
    double range_min, range_max;
    enum look look;
    bool dark, strip;
    enum language language;
    enum directions_look directions;
    bool light_of_plant; /* true: the message had `light: null`: the view gets the light of a new view */
    double light_dir[3];
    int environment;
    int selected_asset;
    /* With the bit GIVEN_SENSORS, field.overrides has the strength and decay of the sensors named in the message. A value that
       the message omits is FIELD_AS_CONFIGURED; if it omits both, the sensor gets back its configured strength and decay */
    bool only_these_sensors; /* true: the message had `sensors: null`, which removes the overrides of all sensors that it does not name */
    enum baseline_change baseline;
    char baseline_name[BASELINE_NAME_BYTES];
    struct visibility visibility;
};

struct fit_message {
    struct framing framing;
    int projection; /* enum projection; PROJECTION_AS_IT_IS: not in the message, so the view keeps its own */
};

struct split_change {
    enum { SPLIT_AS_IS, SPLIT_OFF, SPLIT_ON } mode;
    struct params_change right;
};

struct pick_request {
    double x_px, y_px;
    bool has_camera; /* true: the client asks what is at a pixel of a picture taken from `camera`; false: from its newest camera */
    struct camera camera;
};

enum { ALARM_REQUEST_MOST = 256 };
struct alarm_request {
    int action;                          /* action that the user performs on the alarms, such as acknowledging (enum alarm_event) */
    /* indices of the tags whose alarms the request names; for alarms of kind ALARM_LINK, indices of devices (alarm/devices.h) */
    int tags[ALARM_REQUEST_MOST], count;
    uint8_t kinds[ALARM_REQUEST_MOST]; /* kind of each alarm (enum alarm_kind), in the order of `tags` */
    double for_s;
    char reason[ALARM_REASON_BYTES], name[ALARM_NAME_BYTES - 24];
};

#define TIME_MOST_SPEED 3600
struct time_request {
    bool has_at;   /* true: the session moves to the instant at_us; false: it stays at the instant shown */
    int64_t at_us; /* microseconds UTC; 0: live */
    double speed;  /* seconds of history per second of playback; negative: backwards; 0: paused */
};

enum { CODEC_LIST_MOST = 4 };
struct codec_list { /* codecs that a client can decode, preferred one first */
    enum wire_codec at[CODEC_LIST_MOST];
    int count;
    bool choose; /* true: the server may choose any codec in this list, and change its choice later */
};

struct place_request {
    struct place_move moves[PLACING_MOVES];
    size_t count;
};

struct coverage_request {
    int group;    /* index of the group of sensors whose coverage of the surfaces is assessed; -1: the group shown in the view */
    double far_m; /* metres from the nearest sensor beyond which a surface counts as not covered; 0: the default */
};

struct loop_check_request {
    int tag;
    double expected, tolerance;
    /* true: the user records the loop check (test of a tag with a value forced at its transmitter) as failed, whatever the
       reading is */
    bool fail;
    char remark[LOOP_CHECK_REMARK_BYTES];
};

struct note_request {
    char id[NOTE_ID_BYTES], text[NOTE_TEXT_BYTES], name[ALARM_NAME_BYTES - 24];
    /* message remove_note: `id` is the note to remove; message note: `id` is the note that the new note replaces, "": none */
    int tag, asset; /* index of the tag or asset to which the note is attached; -1: none */
    bool has_position;
    double position_m[3];
    int64_t until_us; /* time when the note expires, microseconds UTC; 0: it stays until a user removes it */
};

struct wall_request {
    struct wall_place place;
    char desk[WALL_DESK_BYTES];
    bool held, has_position;
    double position_m[3];
};

struct pair_request {
    /* digits: message pair: the digits that the display shows; device: message unpair: name of the display's device */
    char digits[7], device[64];
};

struct hello_request {
    /* access token, and the resume token of an earlier session; empty: none */
    char token[TOKEN_MAX_CHARS + 1], resume[RESUME_MOST_CHARS + 1];
    double idle_ms; /* milliseconds since the last input of the user; negative: not stated */
    bool tokens;    /* true: the server must send the view as a token whenever the view changes */
    bool depth;     /* true: the client wants depth grids with its frames */
    bool anew;      /* true: the client continues the earlier session (its id and its followers), but does not want that session's view */
    bool has_camera, has_params;
    /* the tile that this display shows of a picture spread over many displays; display 0: this client shows no tile */
    struct wall_place tile;
};

struct size_request {
    int width_px, height_px; /* size of the view in pixels; 0: as in the resumed session */
    double pixel_ratio;      /* device pixels per CSS pixel of the page; 0: not stated */
};

struct ping_request {
    double t;    /* the client's time stamp, which the server returns in its answer */
    bool active; /* true: the user was active since the last ping */
};

struct tag_list_request {
    char confirm[17];             /* hash of the tag list that the user saw and confirmed; empty: not confirmed yet */
    struct assumed_filter accept; /* message accept_places: filter that selects the assumed positions to accept */
    char kept[65];                /* message restore_tags: name of the earlier tag list version to restore */
};

struct message {
    enum message_type type;
    struct hello_request hello;
    struct size_request size;        /* messages hello and resize */
    struct codec_list codecs;        /* messages hello and codecs: codecs that the client can decode; empty: as in the resumed session */
    char named[NAMED_VIEW_ID_BYTES]; /* messages hello, look and params: id of a named view; empty: no view (only in hello and params) */
    bool has_new_view;               /* message params: `named` is null: the parameters begin with those of a new view */
    struct camera camera;            /* messages camera and hello: the new camera */
    /* the client's sequence number of its message camera, ack, fit, pick or look; message hello: that of its camera */
    uint32_t seq;
    struct params_change params;     /* messages params and hello: parameters of the view to change */
    struct split_change split;       /* messages params and hello: change to the right half of a split view, applied after `params` */
    struct fit_message fit;
    struct pick_request pick;
    bool visible;
    double decode_ms; /* message ack: milliseconds that the client needed to decode the frame; negative: not stated */
    struct ping_request ping;
    uint64_t follow;  /* messages follow and lead: number of the other session to follow, or to which the lead is handed; 0: no session */
    struct alarm_request alarm;
    struct time_request time; /* messages time and hello: the past or present time that the view is to show */
    struct place_request place;
    struct coverage_request coverage;
    struct tag_list_request tag_list; /* messages save_tags, accept_places and restore_tags */
    struct loop_check_request loop_check;
    /* messages that edit or share a named view: save_view sets all members, remove_view only the id, share_view only the
       address, send_to_wall only view and title */
    struct named_view_edit view_edit;
    struct note_request note;         /* messages note and remove_note: the note to add, or to remove */
    /* messages display, send_to_wall and point: the display, or the pane of a display, to which the message refers */
    struct wall_request wall;
    struct pair_request pair;         /* messages pair and unpair: the display that is to be paired, or whose pairing is to end */
    enum signed_frames signed_frames; /* messages hello and sign: frames that the server must sign */
};

/* Parses the argument `name` as a timestamp (timestamp.h) into *out, microseconds UTC. Returns false, with *error set, if the
   text is not a timestamp. */
bool message_take_time(const char *name, const char *text, int64_t now_us, int64_t *out, struct message_error *error);

/* Parses the members of a params message from an object, which may also have other members. Returns false with *error naming
   the wrong member. */
bool params_parse(const struct plant *plant, const json_t *object, struct params_change *out, struct message_error *error);
struct params_context {
    const struct scene *scene;
    /* store of the plant's baselines (saved readings that differences are shown against); NULL: baselines are not available */
    struct baselines *baselines;
    /* present readings, which a change of parameters may save as a baseline; NULL: it may not save any */
    const struct snapshot *snapshot;
    int64_t now_us;                  /* current UTC time in microseconds, against which times in a query's arguments are checked */
    bool bare;                       /* true (only in queries): the picture has no legend and no clock */
};
/* Applies a change of parameters to a view. If part of the change is invalid, returns false with *error and leaves the view
   unchanged. If the change names another group, the view first gets that group's default parameters. */
bool params_apply(const struct params_context *context, const struct params_change *change, struct view *view, struct message_error *error);
/* params_parse() and params_apply() call these functions for the members `show`, `sensor`, `baseline` and `sensors`. */
bool params_parse_show(const struct plant *plant, const json_t *o, struct params_change *out, struct message_error *error);
bool params_apply_show(const struct params_context *context, const struct params_change *change, const struct view *before,
                       struct view *view, struct message_error *error);
/* Saves the present readings as the baseline that the change of parameters names, or removes that baseline. Call it last, after
   all checks of the change, because it cannot be undone. */
void params_apply_baseline(const struct params_context *context, const struct params_change *change, struct view *view);
/* params_parse() and params_apply() call these functions for the members `scale`, `breaks` (limits between colour bands) and
   `isolines`. */
bool params_parse_paint(const json_t *o, struct params_change *out, struct message_error *error);
bool params_apply_paint(const struct plant *plant, const struct params_change *change, struct view *view, struct message_error *error);
/* split_parse() and split_apply() parse and apply the member `split`, which describes the right half of a split view (params_split.c). */
bool split_parse(const struct plant *plant, const json_t *o, struct split_change *out, struct message_error *error);
bool split_apply(const struct params_context *context, const struct split_change *change, struct view *view, struct message_error *error);
/* Returns true if that width and height in pixels are valid for a view. */
bool view_size_valid(double width_px, double height_px);

#endif
