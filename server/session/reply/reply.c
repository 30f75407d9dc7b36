/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds short messages to clients: lists of followers, answers to picks (clicks on the picture), errors, and messages to the
   tiles of a wall (displays that show parts of one picture). */
#include "session/reply/reply_impl.h"

#include "base/text/json_text.h"
#include "message/json_values.h"
#include "message/names.h"
#include "value/quality.h"

char *reply_followers_text(const struct session *const *followers, size_t count, bool open)
{
    json_t *sessions = json_array(), *names = json_array();
    for (size_t i = 0; i < count && i < REPLY_FOLLOWERS; i++) {
        const char *name = followers[i]->identity.holder.name;
        json_array_append_new(sessions, json_integer((json_int_t)followers[i]->identity.number));
        json_array_append_new(names, name[0] ? string(name) : json_null());
    }
    json_t *object = json_pack("{s:s,s:I,s:o}", "type", "followers", "count", (json_int_t)count, "sessions", sessions);
    if (!open)
        json_object_set(object, "names", names);
    json_decref(names);
    return json_text(object, DIGITS);
}

static json_t *nearest(const struct plant *plant, const struct pick *pick)
{
    json_t *list = json_array();
    for (int i = 0; i < pick->nearest_count; i++) {
        const struct pick_sensor *at = &pick->nearest[i];
        json_array_append_new(list,
                              json_pack("{s:o,s:o,s:o,s:o}", "tag", string(plant->tags[at->tag].name), "distance_m", number(at->distance_m),
                                        "value", number(at->value), "quality", string(quality_class(at->quality))));
    }
    return list;
}

char *reply_picked_text(const struct plant *plant, const struct pick_answer *answer)
{
    const struct pick *pick = &answer->pick;
    bool found = pick->asset >= 0, told = pick->state == PICK_BETWEEN || pick->state == PICK_MEASURED;
    struct view half;
    view_half(&answer->query.view, answer->query.view.split && answer->query.x_px >= view_left_px(&answer->query.view), &half);
    json_t *object =
        json_pack("{s:s,s:I,s:o,s:o,s:o,s:s}", "type", "picked", "time_us", us(pick->data_utc_ns), "asset",
                  found ? string(plant->assets[pick->asset].id) : json_null(), "position", found ? vector(pick->position_m) : json_null(),
                  "normal", found ? vector(pick->normal) : json_null(), "state", name_of(names_pick, (int)pick->state));
    if (answer->query.seq)
        json_object_set_new(object, "seq", json_integer(answer->query.seq));
    json_object_set_new(object, "value", told ? number(pick->value) : json_null());
    json_object_set_new(object, "unit", string(view_unit(plant, &half)));
    json_object_set_new(object, "uncertain", json_boolean(told && pick->uncertain));
    if (told && pick->drawn_error > 0)
        json_object_set_new(object, "drawn_error", number(pick->drawn_error));
    json_object_set_new(object, "inside", json_boolean(found && pick->inside));
    json_object_set_new(object, "nearest", nearest(plant, pick));
    if (told && pick->assumed)
        json_object_set_new(object, "place", json_string("equipment"));
    json_object_set_new(object, "sensor", pick->sensor < 0 ? json_null() : string(plant->tags[pick->sensor].name));
    json_object_set_new(object, "occluded", json_boolean(pick->sensor >= 0 && pick->sensor_occluded));
    return json_text(object, DIGITS);
}

char *reply_error_text(const struct message_error *error)
{
    json_t *object = json_pack("{s:s,s:s,s:o,s:o}", "type", "error", "code", error->code, "text", string(error->text), "about",
                               error->about[0] ? string(error->about) : json_null());
    if (error->refusal.code)
        json_object_set_new(object, "refusal", refusal_json(&error->refusal));
    if (error->retry_after_s > 0)
        json_object_set_new(object, "retry_after_s", json_integer(error->retry_after_s));
    return json_text(object, DIGITS);
}

char *reply_present_text(uint32_t seq, uint64_t picture, int64_t at_us)
{
    return json_text(json_pack("{s:s,s:I,s:I,s:I}", "type", "present", "seq", (json_int_t)seq, "picture", (json_int_t)picture, "at_us",
                               (json_int_t)at_us),
                     0);
}

char *reply_tiles_text(const struct wall *wall, const struct wall_place *place, const struct tile_layout *layout, const bool *there,
                       const int64_t *late_us, bool leads)
{
    double width = tile_layout_width(layout), height = tile_layout_height(layout);
    struct frame_part part = tile_layout_part(layout, place->display);
    json_t *missing = json_array(), *late = json_array();
    for (int i = 0; i < wall->tile.columns * wall->tile.rows; i++) {
        if (!there[i])
            json_array_append_new(missing, json_integer(i + 1));
        else if (late_us[i])
            json_array_append_new(late, json_pack("{s:i,s:I}", "display", i + 1, "since_us", (json_int_t)late_us[i]));
    }
    json_t *shares = json_pack("[f,f,f,f]", part.x_px / width, part.y_px / height, part.width_px / width, part.height_px / height);
    return json_text(json_pack("{s:s,s:i,s:i,s:i,s:o,s:b,s:o,s:o}", "type", "tiles", "columns", wall->tile.columns, "rows",
                               wall->tile.rows, "display", place->display, "part", shares, "leads", leads, "missing", missing, "late",
                               late),
                     DIGITS);
}
