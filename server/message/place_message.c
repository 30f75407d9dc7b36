/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses messages about the positions of sensors and formats the answers. */
#include "message/place_message.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/json_text.h"
#include "message/json_fields.h"
#include "message/json_values.h"
#include "plant/models/transform.h"
#include "plant/tags/tag_edit.h"
#include "scene/far_sensors.h"

/* Returns the path of the tag list's file with symlinks resolved, because saving replaces the target file and stores earlier
   versions next to it. */
static const char *list_path(const struct plant *plant, char real[PATH_MAX])
{
    const char *path = plant->files.tags_path ? realpath(plant->files.tags_path, real) : NULL;
    return path ? path : plant->files.tags_path ? plant->files.tags_path : "";
}

/* --- parsing messages ---------------------------------------------------------------------------------------------------------- */

static bool take_move(const struct plant *plant, const json_t *o, struct place_move *out, struct message_error *error)
{
    const char *tag = json_string_value(json_object_get(o, "tag")), *asset = json_string_value(json_object_get(o, "asset"));
    char name[48];
    out->tag = tag ? plant_find_tag(plant, tag) : -1;
    out->asset = asset ? plant_find_asset(plant, asset) : -1;
    if (!tag || !asset)
        message_fail(error, "bad_field", "moves: expected objects with tag, asset and position");
    else if (out->tag < 0)
        message_refuse_with(error, "bad_field", "moves", REFUSAL_NO_TAG, "name=%s", quoted(tag, name));
    else if (out->asset < 0)
        message_refuse_with(error, "bad_field", "moves", REFUSAL_NO_ASSET, "name=%s", quoted(asset, name));
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
        message_fail(error, "bad_field", "moves: expected a list of at most %d moves", PLACING_MOVES);
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
        message_refuse_with(error, "bad_field", "group", REFUSAL_NO_GROUP, "name=%s", quoted(group, name));
        return false;
    }
    return need_seq(o, &out->seq, error) && may_number(o, "far_m", 1e-3, 1e6, &out->coverage.far_m, NULL, error);
}

bool save_tags_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    (void)plant;
    return need_seq(o, &out->seq, error) && may_text(o, "confirm", out->tag_list.confirm, sizeof(out->tag_list.confirm), NULL, error);
}

/* Returns true if a glob pattern has few enough stars to be matched fast: each star multiplies the time that a long name may take. */
static bool is_simple(const char *pattern)
{
    int stars = 0;
    for (const char *at = pattern; *at; at++)
        stars += *at == '*';
    return stars <= 4 && !strchr(pattern, '[');
}

bool accept_places_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    struct assumed_filter *filter = &out->tag_list.accept;
    const char *asset = json_string_value(json_object_get(o, "asset")), *group = json_string_value(json_object_get(o, "group"));
    char name[48];
    *filter = (struct assumed_filter){ .asset = asset ? plant_find_asset(plant, asset) : -1,
                                       .group = group ? plant_find_group(plant, group) : -1,
                                       .within_m = -1,
                                       .confidence = -1 };
    if (asset && filter->asset < 0)
        message_refuse_with(error, "bad_field", "asset", REFUSAL_NO_ASSET, "name=%s", quoted(asset, name));
    else if (group && filter->group < 0)
        message_refuse_with(error, "bad_field", "group", REFUSAL_NO_GROUP, "name=%s", quoted(group, name));
    else if (!need_words(o, "pattern", false, filter->pattern, sizeof(filter->pattern), error))
        return false;
    else if (!is_simple(filter->pattern))
        message_refuse(error, "bad_field", "pattern", REFUSAL_PATTERN);
    else
        return may_number(o, "within_m", 0, 1e6, &filter->within_m, NULL, error) &&
               may_number(o, "confidence", 0, 1, &filter->confidence, NULL, error) && save_tags_parse(plant, o, out, error);
    return false;
}

bool restore_tags_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    char real[PATH_MAX];
    const char *base = text_base_name(list_path(plant, real));
    size_t n = strlen(base);
    if (!need_words(o, "kept", true, out->tag_list.kept, sizeof(out->tag_list.kept), error) || !save_tags_parse(plant, o, out, error))
        return false;
    const char *number = out->tag_list.kept + n + 1;
    if (!strncmp(out->tag_list.kept, base, n) && out->tag_list.kept[n] == '.' && *number && strspn(number, "0123456789") == strlen(number))
        return true;
    message_fail(error, "bad_field", "kept: expected a version of the tag list, such as %s.1", base);
    return false;
}

/* --- answers ------------------------------------------------------------------------------------------------------------------- */

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

/* Lists the sensors of a group whose position is too far from their asset's surface, as JSON. For a sensor moved on trial, the
   trial position counts; assumed positions do not. */
static json_t *far_list(const struct scene *scene, const struct place_set *set, int group)
{
    const struct placed *placed = NULL;
    size_t count = set ? place_set_get(set, &placed) : 0;
    json_t *list = json_array();
    for (size_t a = 0; a < scene->asset_count; a++)
        for (size_t s = 0; s < scene->assets[a].sensor_count; s++) {
            const struct scene_sensor *sensor = &scene->assets[a].sensors[s];
            const struct plant_tag *tag = &scene->plant->tags[sensor->tag];
            bool moved = false;
            for (size_t i = 0; i < count; i++)
                moved |= placed[i].move.tag == sensor->tag;
            if (!moved && tag->group == group && !tag->place.assumed)
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
        json_t *said = json_pack("{s:s,s:i,s:b}", "asset", plant->assets[answer->assets[i].asset].id, "sensors", (int)coverage->sensors,
                                 "assumed", coverage->assumed);
        json_array_append_new(assets, said);
        if (coverage->assumed)
            continue;
        const int *pair = coverage->next_tags;
        json_t *next = pair[0] < 0 ? json_null() : json_pack("[s,s]", plant->tags[pair[0]].name, plant->tags[pair[1]].name);
        json_object_update_new(said, json_pack("{s:f,s:f,s:o}", "far_m", coverage->far_m, "farthest_m", coverage->farthest_m, "farthest_at",
                                               vector(coverage->farthest_at_m)));
        json_object_update_new(said, json_pack("{s:f,s:f,s:f,s:f,s:f,s:o}", "farthest_error_m", coverage->farthest_error_m, "far_share",
                                               coverage->far_share, "lost_share", coverage->lost_share, "unsure_share",
                                               coverage->unsure_share, "next_m", coverage->next_m, "next", next));
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

/* Returns the tag list `before` with the positions of the sensors in `set` replaced (free with mem_free()), or NULL with the
 * reason in why. */
static char *edited(const struct plant *plant, const char *before, const struct place_set *set, struct refusal *why)
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

char *tags_refused_text(uint32_t seq, const struct refusal *why)
{
    char text[REFUSAL_TEXT_BYTES];
    refusal_text(why, text);
    return json_text(json_pack("{s:s,s:I,s:b,s:[o],s:o}", "type", "tags_saved", "seq", (json_int_t)seq, "saved", false, "errors",
                               string(text), "refusal", refusal_json(why)),
                     9);
}

static char *conflict_text(const struct plant *plant, const struct message *message, const char *before, const char *now)
{
    size_t more;
    json_t *lines = lines_of(before, now, &more);
    return json_text(json_pack("{s:s,s:I,s:s,s:b,s:n,s:o,s:I}", "type", "tags_diff", "seq", (json_int_t)message->seq, "file",
                               text_base_name(plant->files.tags_path), "conflict", true, "hash", "lines", lines, "more", (json_int_t)more),
                     9);
}

/* Returns a request to save the tag list `after`, or NULL unless the user has confirmed exactly that list (the message has its
   hash). Takes ownership of `after`. */
static struct tag_save *order_of(const struct plant *plant, const char *before, char *after, const struct message *message, const char *who)
{
    char hash[17], real[PATH_MAX];
    tag_file_hash(after, hash);
    if (!message->tag_list.confirm[0] || strcmp(message->tag_list.confirm, hash) != 0) {
        mem_free(after);
        return NULL;
    }
    struct tag_save *order = mem_new(sizeof(*order));
    *order = (struct tag_save){ .path = mem_strdup(list_path(plant, real)),
                                .before = mem_strdup(before),
                                .after = after,
                                .who = mem_strdup(who),
                                .seq = message->seq };
    return order;
}

/* Returns the tag list requested by the message, made from the list `before` (free with mem_free()), or NULL with the reason in *why. */
static char *wanted_list(const struct scene *scene, const char *before, const struct place_set *set, const struct message *message,
                         uint8_t *outcome, struct refusal *why)
{
    const struct plant *plant = scene->plant;
    if (message->type == MESSAGE_RESTORE_TAGS) {
        char real[PATH_MAX];
        const char *list = list_path(plant, real);
        char *path = mem_printf("%.*s%s", (int)(text_base_name(list) - list), list, message->tag_list.kept);
        char *text = tag_file_read(path, why);
        mem_free(path);
        return text;
    }
    if (message->type != MESSAGE_ACCEPT_PLACES)
        return edited(plant, before, set, why);
    assumed_places_choose(scene, &message->tag_list.accept, outcome);
    return assumed_places_accept(plant, before, outcome, why);
}

static char *diff_text(const struct plant *plant, const struct message *message, const char *before, const char *after)
{
    size_t more;
    char hash[17];
    json_t *lines = lines_of(before, after, &more);
    tag_file_hash(after, hash);
    return json_text(json_pack("{s:s,s:I,s:s,s:b,s:s,s:o,s:I}", "type", "tags_diff", "seq", (json_int_t)message->seq, "file",
                               text_base_name(plant->files.tags_path), "conflict", false, "hash", hash, "lines", lines, "more",
                               (json_int_t)more),
                     9);
}

static json_t *names_of(const struct plant *plant, const uint8_t *outcome, enum assumed_outcome wanted, size_t most, size_t *count)
{
    json_t *names = json_array();
    *count = 0;
    for (size_t i = 0; i < plant->tag_count; i++)
        if (outcome[i] == wanted && (*count)++ < most)
            json_array_append_new(names, json_string(plant->tags[i].name));
    return names;
}

static char *accepted_text(const struct plant *plant, const struct message *message, const uint8_t *outcome, const char *after)
{
    static const char *const causes[ASSUMED_OUTCOMES] = {
        [ASSUMED_NOWHERE] = "nowhere", [ASSUMED_MISSING] = "missing", [ASSUMED_FAR] = "far", [ASSUMED_UNSURE] = "unsure"
    };
    enum { ACCEPTED_NAMES = 5000, REFUSED_NAMES = 50 };
    json_t *refused = json_array();
    char hash[17];
    size_t count;
    tag_file_hash(after, hash);
    for (int i = ASSUMED_NOWHERE; i < ASSUMED_OUTCOMES; i++) {
        json_t *names = names_of(plant, outcome, (enum assumed_outcome)i, REFUSED_NAMES, &count);
        json_t *cause = json_pack("{s:s,s:I,s:o}", "cause", causes[i], "count", (json_int_t)count, "tags", names);
        if (count > 0)
            json_array_append(refused, cause);
        json_decref(cause);
    }
    json_t *names = names_of(plant, outcome, ASSUMED_ACCEPTED, ACCEPTED_NAMES, &count);
    return json_text(json_pack("{s:s,s:I,s:s,s:I,s:o,s:o,s:s}", "type", "places_accepted", "seq", (json_int_t)message->seq, "file",
                               text_base_name(plant->files.tags_path), "count", (json_int_t)count, "tags", names, "refused", refused,
                               "hash", hash),
                     0);
}

char *tags_diff_text(const struct scene *scene, const char *before, const struct place_set *set, const struct message *message,
                     const char *who, struct tag_save **order)
{
    const struct plant *plant = scene->plant;
    struct refusal why;
    char *now = tag_file_read(plant->files.tags_path, &why), *text = NULL;
    uint8_t *outcome = mem_array(plant->tag_count + 1, 1);
    bool conflict = now && strcmp(now, before) != 0;
    char *after = now && !conflict ? wanted_list(scene, before, set, message, outcome, &why) : NULL;
    *order = NULL;
    if (conflict)
        text = conflict_text(plant, message, before, now);
    else if (!after)
        text = tags_refused_text(message->seq, &why);
    else if (message->type == MESSAGE_ACCEPT_PLACES)
        text = accepted_text(plant, message, outcome, after);
    else
        text = diff_text(plant, message, before, after);
    if (after)
        *order = order_of(plant, before, after, message, who);
    mem_free(outcome);
    mem_free(now);
    return text;
}
