/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a client says: JSON text to a checked struct. The one place where input of clients is read and judged; pure. */
#ifndef MESSAGE_MESSAGE_H
#define MESSAGE_MESSAGE_H
#include <jansson.h>

#include "alarm/alarms.h"
#include "placing/placing.h"
#include "protocol/wire.h"
#include "loopcheck/loop_checks.h"
#include "render/view.h"
#include "scene/framing.h"

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
    MESSAGE_GAPS,
    MESSAGE_SAVE_TAGS,
    MESSAGE_PROVE
};

enum { TOKEN_MAX_CHARS = 128, RESUME_CHARS = 32 };

struct message_error {
    const char *code; /* of PROTOCOL.md */
    char text[240];
    char about[24];    /* type of the message; "": unknown */
    int retry_after_s; /* 0: there is nothing to wait for */
};

enum params_given { /* which fields of a params message were there */
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
};

enum baseline_change { BASELINE_STAYS, BASELINE_NONE, BASELINE_NAMED, BASELINE_NOW, BASELINE_SET, BASELINE_REMOVE };

struct params_change {
    uint32_t seq;
    unsigned given;            /* enum params_given */
    struct field_params field; /* only what was given is set; so below */
    int colormap;
    double ramp_interval;
    struct color_scale color_scale;
    double isoline_step; /* isolines: a number; 0: paint.lines */
    bool breaks_of_group, breaks_of_limits;
    bool range_of_group; /* range: null */
    double range_min, range_max;
    enum look look;
    bool dark;
    double light_dir[3];
    int environment;
    int selected_asset;
    /* field.overrides, if GIVEN_SENSORS: those named; a strength or decay left out is FIELD_AS_CONFIGURED, and so is either where
       the sensor's is to go */
    bool only_these_sensors; /* sensors: null; all others go */
    enum baseline_change baseline;
    char baseline_name[BASELINE_NAME_BYTES];
    struct visibility visibility;
};

struct fit {
    struct framing framing;
    int projection; /* enum projection, or PROJECTION_AS_IT_IS */
};

struct split_change {
    enum { SPLIT_AS_IS, SPLIT_OFF, SPLIT_ON } wish;
    struct params_change right;
};

struct pick_request {
    double x_px, y_px;
    bool has_camera; /* else: the newest */
    struct camera camera;
};

enum { ALARM_REQUEST_MOST = 256 };
struct alarm_request {
    int action;                          /* enum alarm_event */
    int tags[ALARM_REQUEST_MOST], count; /* ALARM_LINK: index of a device (alarm/devices.h) */
    uint8_t kinds[ALARM_REQUEST_MOST];   /* enum alarm_kind */
    double for_s;
    char reason[ALARM_REASON_BYTES], name[ALARM_NAME_BYTES - 24];
};

#define TIME_MOST_SPEED 3600
struct time_request {
    bool has_at;   /* else: from where it is */
    int64_t at_us; /* 0: now */
    double speed;  /* of play: seconds of the past in each second; negative: backwards; 0: stands */
};

enum { CODEC_LIST_MOST = 4 };
struct codec_list { /* what a client decodes, what it likes best first */
    enum wire_codec at[CODEC_LIST_MOST];
    int count;
    bool choose; /* the server may choose among them, and choose again */
};

struct place_request {
    struct place_move moves[PLACING_MOVES];
    size_t count;
};

struct gaps_request {
    int group;    /* -1: the one that is shown */
    double far_m; /* 0: as usual */
};

struct prove_request {
    int tag;
    double expected, tolerance;
    bool fail; /* whatever the value is */
    char remark[LOOP_CHECK_REMARK_BYTES];
};

struct message {
    enum message_type type;
    int width_px, height_px;                                   /* hello, resize; 0: as what is resumed */
    struct codec_list codecs;                                  /* hello, codecs; none: as what is resumed */
    double pixel_ratio;                                        /* hello, resize: device pixels to one of the page's; 0: not said */
    char token[TOKEN_MAX_CHARS + 1], resume[RESUME_CHARS + 1]; /* hello; "": none */
    bool anew;                                                 /* hello: of what is resumed only its number, and who follows it */
    bool has_camera, has_params;                               /* hello */
    struct camera camera;                                      /* camera, hello */
    uint32_t seq;                                              /* camera (hello: the camera's), ack, fit, pick */
    struct params_change params;                               /* params, hello */
    struct split_change split;                                 /* likewise; applied after params */
    struct fit fit;
    struct pick_request pick;
    bool visible;
    double decode_ms; /* ack; negative: not said */
    double t;         /* ping */
    uint64_t follow;  /* follow, lead: a session; 0: none */
    struct alarm_request alarm;
    struct time_request time; /* time, hello */
    struct place_request place;
    struct gaps_request gaps;
    char confirm[17]; /* save_tags: hash of the list that was seen; "": none yet */
    struct prove_request prove;
};

/* False: *error is what to answer. text need not end in 0. */
bool message_parse(const struct plant *plant, const char *text, size_t count, struct message *out, struct message_error *error);
void message_fail(struct message_error *error, const char *code, const char *fmt, ...) __attribute__((format(printf, 3, 4)));
/* Reads an instant (base/timestamp.h) of the field `name`. Returns false, with *error set, for any other text. */
bool message_take_time(const char *name, const char *text, int64_t now_us, int64_t *out, struct message_error *error);

/* Reads the fields of a params message from an object that may hold others. False: *error names the field. */
bool params_parse(const struct plant *plant, const json_t *object, struct params_change *out, struct message_error *error);
struct params_context {
    const struct scene *scene;
    struct baselines *baselines;     /* NULL: there are none */
    const struct snapshot *snapshot; /* what may be kept as a baseline; NULL: nothing */
    int64_t now_us;                  /* UTC; of a query */
    bool bare;                       /* of a query: its picture has no legend and no clock */
};
/* Applies a change to a view: all of it, or nothing and *error. A new group brings its own settings first. */
bool params_apply(const struct params_context *world, const struct params_change *change, struct view *view, struct message_error *error);
/* Parts of the two above: what is shown, of which sensor, against what, and overrides of single sensors (params_show.c). */
bool params_parse_show(const struct plant *plant, const json_t *o, struct params_change *out, struct message_error *error);
bool params_apply_show(const struct params_context *world, const struct params_change *change, const struct view *before, struct view *view,
                       struct message_error *error);
/* The last step of a change that is good: keeps or forgets a baseline. */
void params_apply_baseline(const struct params_context *world, const struct params_change *change, struct view *view);
/* Likewise: scale, breaks and isolines (params_paint.c). */
bool params_parse_paint(const json_t *o, struct params_change *out, struct message_error *error);
bool params_apply_paint(const struct plant *plant, const struct params_change *change, struct view *view, struct message_error *error);
/* The right half of a split view (params_split.c). */
bool split_parse(const struct plant *plant, const json_t *o, struct split_change *out, struct message_error *error);
bool split_apply(const struct params_context *world, const struct split_change *change, struct view *view, struct message_error *error);
/* Reads the fields of a camera message, but for seq. */
bool camera_parse(const json_t *object, struct camera *out, struct message_error *error);
bool view_size_valid(double width_px, double height_px);

#endif
