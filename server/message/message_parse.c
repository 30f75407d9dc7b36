/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses a client's JSON message into a struct message and checks its values. */
#include "message/message_parse.h"

#include <stdio.h>
#include <string.h>

#include "message/alarm_message.h"
#include "message/json_fields.h"
#include "message/fit_message.h"
#include "message/place_message.h"
#include "message/loop_check_message.h"
#include "message/note_message.h"
#include "message/views_message.h"
#include "message/wall_message.h"

static bool size_parse(const json_t *o, struct message *out, struct message_error *error)
{
    double w, h;
    if (!need_number(o, "width", 16, VIEW_MAX_SIDE_PX, &w, error) || !need_number(o, "height", 16, VIEW_MAX_SIDE_PX, &h, error))
        return false;
    if (!view_size_valid(w, h)) {
        message_fail(error, "bad_field", "width, height: expected whole numbers, and at most %d pixels in the picture", VIEW_MAX_PIXELS);
        return false;
    }
    out->size.width_px = (int)w;
    out->size.height_px = (int)h;
    return may_number(o, "pixel_ratio", 0.25, 8, &out->size.pixel_ratio, NULL, error);
}

static bool parse_camera(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    (void)plant;
    return need_seq(o, &out->seq, error) && camera_parse(o, &out->camera, error);
}

static bool parse_params(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    uint32_t seq;
    out->has_new_view = json_is_null(json_object_get(o, "named"));
    if (!need_seq(o, &seq, error) || (!out->has_new_view && !may_text(o, "named", out->named, sizeof(out->named), NULL, error)) ||
        !params_parse(plant, o, &out->params, error) || !split_parse(plant, o, &out->split, error))
        return false;
    out->params.seq = seq;
    return true;
}

static void add_codec(struct codec_list *list, int codec)
{
    for (int i = 0; i < list->count; i++)
        if ((int)list->at[i] == codec)
            return;
    if (list->count < CODEC_LIST_MOST)
        list->at[list->count++] = (enum wire_codec)codec;
}

/* Reads a list of codecs. Ignores unknown names, which may come from a later version of the protocol. */
static bool parse_codecs(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    (void)plant;
    const json_t *codecs = json_object_get(o, "codecs");
    out->codecs = (struct codec_list){ 0 };
    for (size_t i = 0; i < json_array_size(codecs); i++) {
        const char *name = json_string_value(json_array_get(codecs, i));
        int codec = name ? name_find(names_codec, name) : -1;
        out->codecs.choose |= name && !strcmp(name, "auto");
        if (codec > 0)
            add_codec(&out->codecs, codec);
    }
    if (out->codecs.count > 0)
        return true;
    message_fail(error, "bad_field", "codecs: expected a list with 'h264', 'jpeg' or 'png'");
    return false;
}

static bool parse_key_frame(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    (void)plant;
    (void)o;
    (void)out;
    (void)error;
    return true;
}

/* Reads the message `time`. JSON gives its microseconds as a double, which is exact for any valid time. */
static bool parse_time(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    const json_t *at = json_object_get(o, "at_us");
    double at_us = 0;
    bool has_speed;
    (void)plant;
    out->time = (struct time_request){ .has_at = at != NULL };
    if (!may_number(o, "speed", -TIME_MOST_SPEED, TIME_MOST_SPEED, &out->time.speed, &has_speed, error))
        return false;
    if (at && !json_is_null(at) && !need_number(o, "at_us", 1, 9e15, &at_us, error))
        return false;
    out->time.at_us = (int64_t)at_us;
    if (at || has_speed)
        return true;
    message_fail(error, "bad_field", "at_us, speed: expected at_us (microseconds since 1970 in UTC, or null for the present), or a speed");
    return false;
}

static bool take_signed(const json_t *o, const char *field, struct message *out, bool *given, struct message_error *error)
{
    int frames = SIGNED_NONE;
    bool good = may_name(o, field, names_signed, &frames, given, error);
    out->signed_frames = (enum signed_frames)frames;
    return good;
}

static bool parse_sign(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    bool given;
    (void)plant;
    if (!take_signed(o, "frames", out, &given, error))
        return false;
    if (!given)
        message_fail(error, "bad_field", "frames: expected 'none', 'refined' or 'all'");
    return given;
}

static bool parse_hello(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    const json_t *camera = json_object_get(o, "camera"), *params = json_object_get(o, "params");
    bool resumes, given;
    if (!may_text(o, "token", out->hello.token, sizeof(out->hello.token), NULL, error) ||
        !may_text(o, "resume", out->hello.resume, sizeof(out->hello.resume), &resumes, error) ||
        !may_text(o, "named", out->named, sizeof(out->named), NULL, error))
        return false;
    if (((!resumes || json_object_get(o, "width") || json_object_get(o, "height")) && !size_parse(o, out, error)) ||
        ((!resumes || json_object_get(o, "codecs")) && !parse_codecs(plant, o, out, error)))
        return false;
    if (json_object_get(o, "at_us") && !parse_time(plant, o, out, error))
        return false;
    out->hello.idle_ms = -1;
    if (!may_number(o, "idle_ms", 0, 1e12, &out->hello.idle_ms, NULL, error))
        return false;
    if (!tile_parse(plant, o, out, error) || !take_signed(o, "signed", out, &given, error))
        return false;
    if (out->hello.tile.display && !out->size.width_px) {
        message_fail(error, "bad_field", "tile: requires the fields width and height");
        return false;
    }
    out->hello.tokens = json_is_true(json_object_get(o, "tokens"));
    out->hello.anew = json_is_true(json_object_get(o, "anew"));
    out->hello.depth = json_is_true(json_object_get(o, "depth"));
    out->hello.has_camera = json_is_object(camera);
    out->hello.has_params = json_is_object(params);
    if ((camera && !out->hello.has_camera) || (params && !out->hello.has_params)) {
        message_fail(error, "bad_field", "camera, params: expected objects");
        return false;
    }
    return (!out->hello.has_camera || parse_camera(plant, camera, out, error)) &&
           (!out->hello.has_params || parse_params(plant, params, out, error));
}

static bool parse_resize(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    (void)plant;
    return size_parse(o, out, error);
}

static bool parse_ack(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    (void)plant;
    out->decode_ms = -1;
    return need_seq(o, &out->seq, error) && may_number(o, "decode_ms", 0, 1e7, &out->decode_ms, NULL, error);
}

static bool parse_visible(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    (void)plant;
    const json_t *visible = json_object_get(o, "visible");
    out->visible = json_is_true(visible);
    if (json_is_boolean(visible))
        return true;
    message_fail(error, "bad_field", "visible: expected true or false");
    return false;
}

static bool parse_ping(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    const json_t *active = json_object_get(o, "active");
    (void)plant;
    out->ping.active = json_is_true(active);
    if (!active || json_is_boolean(active))
        return need_number(o, "t", -1e300, 1e300, &out->ping.t, error);
    message_fail(error, "bad_field", "active: expected true or false");
    return false;
}

static bool parse_fit(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    return need_seq(o, &out->seq, error) && fit_parse(plant, o, &out->fit, error);
}

static bool parse_pick(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    const json_t *camera = json_object_get(o, "camera");
    (void)plant;
    out->pick.has_camera = camera != NULL;
    if (camera && !json_is_object(camera)) {
        message_fail(error, "bad_field", "camera: expected an object");
        return false;
    }
    return need_seq(o, &out->seq, error) && need_number(o, "x", 0, VIEW_MAX_SIDE_PX, &out->pick.x_px, error) &&
           need_number(o, "y", 0, VIEW_MAX_SIDE_PX, &out->pick.y_px, error) && (!camera || camera_parse(camera, &out->pick.camera, error));
}

static bool parse_follow(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    const json_t *session = json_object_get(o, "session");
    (void)plant;
    out->follow = json_is_integer(session) && json_integer_value(session) > 0 ? (uint64_t)json_integer_value(session) : 0;
    if (out->follow || json_is_null(session))
        return true;
    message_fail(error, "bad_field", "session: expected a session number, or null");
    return false;
}

static bool parse_lead(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    if (parse_follow(plant, o, out, error) && out->follow)
        return true;
    message_fail(error, "bad_field", "session: expected a session number");
    return false;
}

static bool parse_look(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    (void)plant;
    return need_seq(o, &out->seq, error) && need_words(o, "named", true, out->named, sizeof(out->named), error);
}

static const struct {
    const char *name;
    enum message_type type;
    bool (*parse)(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error);
} types[] = {
    { "hello", MESSAGE_HELLO, parse_hello },
    { "camera", MESSAGE_CAMERA, parse_camera },
    { "params", MESSAGE_PARAMS, parse_params },
    { "resize", MESSAGE_RESIZE, parse_resize },
    { "ack", MESSAGE_ACK, parse_ack },
    { "ping", MESSAGE_PING, parse_ping },
    { "visible", MESSAGE_VISIBLE, parse_visible },
    { "fit", MESSAGE_FIT, parse_fit },
    { "pick", MESSAGE_PICK, parse_pick },
    { "key_frame", MESSAGE_KEY_FRAME, parse_key_frame },
    { "codecs", MESSAGE_CODECS, parse_codecs },
    { "follow", MESSAGE_FOLLOW, parse_follow },
    { "alarm", MESSAGE_ALARM, alarm_parse },
    { "lead", MESSAGE_LEAD, parse_lead },
    { "time", MESSAGE_TIME, parse_time },
    { "place", MESSAGE_PLACE, place_parse },
    { "gaps", MESSAGE_COVERAGE, coverage_parse },
    { "save_tags", MESSAGE_SAVE_TAGS, save_tags_parse },
    { "accept_places", MESSAGE_ACCEPT_PLACES, accept_places_parse },
    { "restore_tags", MESSAGE_RESTORE_TAGS, restore_tags_parse },
    { "prove", MESSAGE_LOOP_CHECK, loop_check_parse },
    { "save_view", MESSAGE_SAVE_VIEW, save_view_parse },
    { "remove_view", MESSAGE_REMOVE_VIEW, remove_view_parse },
    { "share_view", MESSAGE_SHARE_VIEW, share_view_parse },
    { "note", MESSAGE_NOTE, note_parse },
    { "remove_note", MESSAGE_REMOVE_NOTE, remove_note_parse },
    { "display", MESSAGE_DISPLAY, display_parse },
    { "send_to_wall", MESSAGE_SEND_TO_WALL, send_to_wall_parse },
    { "point", MESSAGE_POINT, point_parse },
    { "pair", MESSAGE_PAIR, pair_parse },
    { "unpair", MESSAGE_UNPAIR, unpair_parse },
    { "look", MESSAGE_LOOK, parse_look },
    { "sign", MESSAGE_SIGN, parse_sign },
};

static bool parse_object(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    const char *type = json_string_value(json_object_get(o, "type"));
    char name[48];
    if (!json_is_object(o)) {
        message_fail(error, "not_object", "expected a JSON object with a 'type'");
        return false;
    }
    if (!type) {
        message_fail(error, "no_type", "the message has no 'type', or its 'type' is not a string");
        return false;
    }
    for (size_t i = 0; i < sizeof(types) / sizeof(types[0]); i++) {
        if (strcmp(types[i].name, type) != 0)
            continue;
        snprintf(error->about, sizeof(error->about), "%s", types[i].name);
        out->type = types[i].type;
        return types[i].parse(plant, o, out, error);
    }
    message_fail(error, "unknown_type", "type '%s' is unknown", quoted(type, name));
    return false;
}

bool message_parse(const struct plant *plant, const char *text, size_t count, struct message *out, struct message_error *error)
{
    json_error_t cause;
    *out = (struct message){ 0 };
    *error = (struct message_error){ 0 };
    if (count > WIRE_MAX_MESSAGE_BYTES) {
        message_fail(error, "too_long", "the message has %zu bytes; at most %u are allowed", count, WIRE_MAX_MESSAGE_BYTES);
        return false;
    }
    json_t *o = json_loadb(text, count, JSON_DECODE_ANY, &cause);
    if (!o) {
        char why[48];
        message_fail(error, "not_json", "at byte %d: %s", cause.position, quoted(cause.text, why));
        return false;
    }
    bool good = parse_object(plant, o, out, error);
    json_decref(o);
    return good;
}
