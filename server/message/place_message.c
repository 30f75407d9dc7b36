/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Messages about places of sensors. */
#include "message/place_message.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "base/json_text.h"
#include "base/mem.h"
#include "message/json_fields.h"
#include "message/json_values.h"
#include "plant/tag_edit.h"
#include "plant/transform.h"
#include "scene/far_sensors.h"

/* --- what is said -------------------------------------------------------------------------------------------------------------- */

static bool take_move(const struct plant *plant, const json_t *o, struct place_move *out, struct message_error *error)
{
    const char *tag = json_string_value(json_object_get(o, "tag")), *asset = json_string_value(json_object_get(o, "asset"));
    char name[48];
    out->tag = tag ? plant_find_tag(plant, tag) : -1;
    out->asset = asset ? plant_find_asset(plant, asset) : -1;
    if (!tag || !asset)
        message_fail(error, "bad_field", "moves: objects with tag, asset and position expected");
    else if (out->tag < 0)
        message_fail(error, "bad_field", "moves: there is no tag '%s'", quoted(tag, name));
    else if (out->asset < 0)
        message_fail(error, "bad_field", "moves: there is no asset '%s'", quoted(asset, name));
    else
        return need_vector(o, "position", out->position_m, error);
    return false;
}

bool place_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    const json_t *moves = json_object_get(o, "moves");
    if (!need_seq(o, &out->seq, error))
        return false;
    if (!json_is_array(moves) || json_array_size(moves) > PLACING_MOVES) {
        message_fail(error, "bad_field", "moves: a list of at most %d expected", PLACING_MOVES);
        return false;
    }
    for (out->place.count = 0; out->place.count < json_array_size(moves); out->place.count++)
        if (!take_move(plant, json_array_get(moves, out->place.count), &out->place.moves[out->place.count], error))
            return false;
    return true;
}

bool coverage_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    const char *group = json_string_value(json_object_get(o, "group"));
    char name[48];
    out->coverage.group = group ? plant_find_group(plant, group) : -1;
    if (group && out->coverage.group < 0) {
        message_fail(error, "bad_field", "group: there is no group '%s'", quoted(group, name));
        return false;
    }
    return need_seq(o, &out->seq, error) && may_number(o, "far_m", 1e-3, 1e6, &out->coverage.far_m, NULL, error);
}

bool save_tags_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    (void)plant;
    return need_seq(o, &out->seq, error) && may_text(o, "confirm", out->confirm, sizeof(out->confirm), NULL, error);
}

/* --- what is answered ---------------------------------------------------------------------------------------------------------- */

char *placed_text(const struct plant *plant, const struct place_set *set, uint32_t seq)
{
    static const char *const states[] = { [PLACED_WAITING] = "waiting", [PLACED_READY] = "ready", [PLACED_STRAIGHT] = "straight" };
    const struct placed *placed;
    size_t count = place_set_get(set, &placed);
    json_t *sensors = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(sensors, json_pack("{s:s,s:s,s:o,s:o,s:f,s:f,s:s}", "tag", plant->tags[placed[i].move.tag].name, "asset",
                                                 plant->assets[placed[i].move.asset].id, "position", vector(placed[i].move.position_m),
                                                 "surface", vector(placed[i].surface_m), "distance_m", placed[i].distance_m, "limit_m",
                                                 placed[i].limit_m, "along", states[placed[i].state]));
    return json_text(json_pack("{s:s,s:I,s:o}", "type", "placed", "seq", (json_int_t)seq, "sensors", sensors), 9);
}

static void add_far(json_t *list, const struct plant *plant, int tag, int asset, double distance_m, double limit_m)
{
    if (distance_m > limit_m)
        json_array_append_new(list, json_pack("[s,s,f,f]", plant->tags[tag].name, plant->assets[asset].id, distance_m, limit_m));
}

/* Of the group, as prepared or as tried out. */
static json_t *far_list(const struct scene *scene, const struct place_set *set, int group)
{
    const struct placed *placed = NULL;
    size_t count = set ? place_set_get(set, &placed) : 0;
    json_t *list = json_array();
    for (size_t a = 0; a < scene->asset_count; a++)
        for (size_t s = 0; s < scene->assets[a].sensor_count; s++) {
            const struct scene_sensor *sensor = &scene->assets[a].sensors[s];
            bool moved = false;
            for (size_t i = 0; i < count; i++)
                moved |= placed[i].move.tag == sensor->tag;
            if (!moved && scene->plant->tags[sensor->tag].group == group)
                add_far(list, scene->plant, sensor->tag, (int)a, sensor->surface_distance_m, far_limit_m(&scene->assets[a]));
        }
    for (size_t i = 0; i < count; i++)
        if (scene->plant->tags[placed[i].move.tag].group == group)
            add_far(list, scene->plant, placed[i].move.tag, placed[i].move.asset, placed[i].distance_m, placed[i].limit_m);
    return list;
}

char *coverage_text(const struct scene *scene, const struct place_set *set, const struct sensor_coverage_answer *answer)
{
    const struct plant *plant = scene->plant;
    json_t *assets = json_array();
    for (size_t i = 0; i < answer->count; i++) {
        const struct sensor_coverage *coverage = &answer->assets[i].coverage;
        const int *pair = coverage->next_tags;
        json_t *next = pair[0] < 0 ? json_null() : json_pack("[s,s]", plant->tags[pair[0]].name, plant->tags[pair[1]].name);
        json_t *said =
            json_pack("{s:s,s:i,s:f,s:f,s:o}", "asset", plant->assets[answer->assets[i].asset].id, "sensors", (int)coverage->sensors,
                      "far_m", coverage->far_m, "farthest_m", coverage->farthest_m, "farthest_at", vector(coverage->farthest_at_m));
        json_object_update_new(said, json_pack("{s:f,s:f,s:f,s:o}", "far_share", coverage->far_share, "lost_share", coverage->lost_share,
                                               "next_m", coverage->next_m, "next", next));
        json_array_append_new(assets, said);
    }
    return json_text(json_pack("{s:s,s:I,s:s,s:o,s:o}", "type", "gaps", "seq", (json_int_t)answer->seq, "group",
                               plant->groups[answer->group].id, "far", far_list(scene, set, answer->group), "assets", assets),
                     9);
}

/* --- the tag list --------------------------------------------------------------------------------------------------------------- */

static json_t *line_text(const char *text)
{
    json_t *string = text ? json_string(text) : json_null();
    return string ? string : json_string("(not UTF-8)");
}

static json_t *lines_of(const char *before, const char *after, size_t *more)
{
    struct tag_lines lines = { 0 };
    json_t *list = json_array();
    tag_lines(before, after, &lines);
    for (size_t i = 0; i < lines.count; i++)
        json_array_append_new(list, json_pack("[i,o,o]", lines.at[i].line, line_text(lines.at[i].before), line_text(lines.at[i].after)));
    *more = lines.more;
    tag_lines_finish(&lines);
    return list;
}

/* The list with the moves in it. NULL: *why. */
static char *edited(const struct plant *plant, const char *before, const struct place_set *set, char **why)
{
    struct tag_edit edits[PLACING_MOVES];
    const struct placed *placed;
    size_t count = place_set_get(set, &placed);
    for (size_t i = 0; i < count; i++) {
        const struct place_move *move = &placed[i].move;
        const struct plant_asset *asset = &plant->assets[move->asset];
        double asset_from_plant[16];
        edits[i] = (struct tag_edit){ .tag = plant->tags[move->tag].name,
                                      .asset = plant->tags[move->tag].asset == move->asset ? NULL : asset->id };
        if (!asset->sensors_in_asset_frame || !transform_invert(asset->placement, asset_from_plant))
            memcpy(asset_from_plant, transform_identity, sizeof(asset_from_plant));
        transform_point(asset_from_plant, move->position_m, edits[i].position_m);
    }
    return tag_edit(before, edits, count, why);
}

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

char *tags_saved_text(uint32_t seq, bool saved, const char *why)
{
    return json_text(json_pack("{s:s,s:I,s:b,s:[s]}", "type", "tags_saved", "seq", (json_int_t)seq, "saved", saved, "errors", why), 9);
}

static char *conflict_text(const struct plant *plant, const struct message *message, const char *before, const char *now)
{
    size_t more;
    json_t *lines = lines_of(before, now, &more);
    return json_text(json_pack("{s:s,s:I,s:s,s:b,s:n,s:o,s:I}", "type", "tags_diff", "seq", (json_int_t)message->seq, "file",
                               base_name(plant->tags_path), "conflict", true, "hash", "lines", lines, "more", (json_int_t)more),
                     9);
}

char *tags_diff_text(const struct plant *plant, const char *before, const struct place_set *set, const struct message *message,
                     const char *who, struct tag_save **order)
{
    char *why = NULL, *now = tag_file_read(plant->tags_path, &why), *after = NULL, *text = NULL, hash[17];
    *order = NULL;
    if (now && strcmp(now, before) != 0)
        text = conflict_text(plant, message, before, now);
    else if (now)
        after = edited(plant, before, set, &why);
    if (after) {
        size_t more;
        json_t *lines = lines_of(before, after, &more);
        tag_file_hash(after, hash);
        text = json_text(json_pack("{s:s,s:I,s:s,s:b,s:s,s:o,s:I}", "type", "tags_diff", "seq", (json_int_t)message->seq, "file",
                                   base_name(plant->tags_path), "conflict", false, "hash", hash, "lines", lines, "more", (json_int_t)more),
                         9);
    }
    if (after && message->confirm[0] && !strcmp(message->confirm, hash)) {
        *order = mem_new(sizeof(**order));
        char real[PATH_MAX]; /* through links, so that they stay */
        const char *path = realpath(plant->tags_path, real);
        **order = (struct tag_save){ .path = mem_strdup(path ? path : plant->tags_path),
                                     .before = mem_strdup(before),
                                     .after = after,
                                     .who = mem_strdup(who),
                                     .seq = message->seq };
        after = NULL;
    }
    if (!text)
        text = tags_saved_text(message->seq, false, why);
    mem_free(after);
    mem_free(now);
    mem_free(why);
    return text;
}
