/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts between JSON and struct visibility, which says which assets are hidden, isolated or ghosted, and how the model is clipped. */
#include "message/visibility.h"

#include <math.h>

#include "message/json_fields.h"

static bool parse_set(const struct plant *plant, const json_t *o, const char *name, struct asset_set *out, struct message_error *error)
{
    const json_t *list = json_object_get(o, name);
    char quote[48];
    if (!json_is_array(list)) {
        message_fail(error, "bad_field", "%s: expected a list of asset ids", name);
        return false;
    }
    for (size_t i = 0; i < json_array_size(list); i++) {
        const char *id = json_string_value(json_array_get(list, i));
        int asset = id ? plant_find_asset(plant, id) : -1;
        if (asset < 0 || asset >= ASSET_SET_MAX) {
            const char *said = id ? quoted(id, quote) : "(not a text)";
            if (asset < 0)
                message_refuse_with(error, "bad_field", name, REFUSAL_NO_ASSET, "name=%s", said);
            else
                message_fail(error, "bad_field",
                             "%s: asset '%s': only the first %d assets in the plant file can be hidden, isolated or shown as ghosts", name,
                             said, ASSET_SET_MAX);
            return false;
        }
        asset_set_add(out, asset);
    }
    return true;
}

static bool parse_sets(const struct plant *plant, const json_t *o, struct params_change *out, struct message_error *error)
{
    struct {
        const char *name;
        struct asset_set *set;
        unsigned bit;
    } all[] = {
        { "hidden", &out->visibility.hidden, GIVEN_HIDDEN },
        { "isolate", &out->visibility.isolated, GIVEN_ISOLATE },
        { "ghost", &out->visibility.ghosts, GIVEN_GHOST },
    };
    for (size_t i = 0; i < sizeof(all) / sizeof(all[0]); i++) {
        if (!json_object_get(o, all[i].name))
            continue;
        if (!parse_set(plant, o, all[i].name, all[i].set, error))
            return false;
        out->given |= all[i].bit;
    }
    return true;
}

static bool parse_plane(const json_t *array, double plane[4])
{
    for (size_t i = 0; i < 4; i++) {
        const json_t *number = json_array_get(array, i);
        plane[i] = json_number_value(number);
        if (json_array_size(array) != 4 || !json_is_number(number) || !(fabs(plane[i]) <= PLANT_MAX_M))
            return false;
    }
    double length = sqrt(plane[0] * plane[0] + plane[1] * plane[1] + plane[2] * plane[2]);
    for (int i = 0; i < 4; i++)
        plane[i] /= length;
    return length >= 1e-6 && fabs(plane[3]) <= PLANT_MAX_M;
}

static bool parse_planes(const json_t *planes, struct clip *clip, struct message_error *error)
{
    size_t count = json_array_size(planes);
    bool good = count >= 1 && count <= CLIP_MAX_PLANES;
    for (size_t i = 0; i < count && good; i++)
        good = parse_plane(json_array_get(planes, i), clip->planes[i]);
    clip->plane_count = (int)count;
    if (!good)
        message_fail(error, "bad_field",
                     "clip.planes: expected 1 to %d of [nx, ny, nz, d]; the plant stays visible where nx x + ny y + nz z + d >= 0",
                     CLIP_MAX_PLANES);
    return good;
}

static bool parse_box(const json_t *box, struct clip *clip, struct message_error *error)
{
    double min_m[3], max_m[3];
    if (!need_vector(box, "min", min_m, error) || !need_vector(box, "max", max_m, error))
        return false;
    for (int i = 0; i < 3; i++)
        if (!(min_m[i] < max_m[i])) {
            message_fail(error, "bad_field", "clip.box: expected min below max along each axis");
            return false;
        }
    clip_box(clip, min_m, max_m);
    return true;
}

static bool parse_clip(const json_t *o, struct params_change *out, struct message_error *error)
{
    const json_t *clip = json_object_get(o, "clip");
    const json_t *planes = json_object_get(clip, "planes"), *box = json_object_get(clip, "box");
    if (!clip)
        return true;
    out->given |= GIVEN_CLIP;
    if (json_is_null(clip))
        return true;
    if (json_is_array(planes) && !box)
        return parse_planes(planes, &out->visibility.clip, error);
    if (json_is_object(box) && !planes)
        return parse_box(box, &out->visibility.clip, error);
    message_fail(error, "bad_field", "clip: expected {planes: [[nx, ny, nz, d], ...]}, {box: {min, max}} or null");
    return false;
}

bool visibility_parse(const struct plant *plant, const json_t *o, struct params_change *out, struct message_error *error)
{
    return parse_sets(plant, o, out, error) && parse_clip(o, out, error);
}

void visibility_apply(const struct params_change *change, struct visibility *visibility)
{
    if (change->given & GIVEN_HIDDEN)
        visibility->hidden = change->visibility.hidden;
    if (change->given & GIVEN_ISOLATE)
        visibility->isolated = change->visibility.isolated;
    if (change->given & GIVEN_GHOST)
        visibility->ghosts = change->visibility.ghosts;
    if (change->given & GIVEN_CLIP)
        visibility->clip = change->visibility.clip;
}

static json_t *print_set(const struct plant *plant, const struct asset_set *set)
{
    json_t *list = json_array();
    for (size_t i = 0; i < plant->asset_count && set->count > 0; i++)
        if (asset_set_has(set, (int)i))
            json_array_append_new(list, json_string(plant->assets[i].id));
    return list;
}

static json_t *print_clip(const struct clip *clip)
{
    double min[3], max[3];
    if (clip->plane_count == 0)
        return json_null();
    if (clip->is_box) {
        clip_get_box(clip, min, max);
        return json_pack("{s:{s:[f,f,f],s:[f,f,f]}}", "box", "min", min[0], min[1], min[2], "max", max[0], max[1], max[2]);
    }
    json_t *list = json_array();
    for (int i = 0; i < clip->plane_count; i++) {
        const double *p = clip->planes[i];
        json_array_append_new(list, json_pack("[f,f,f,f]", p[0], p[1], p[2], p[3]));
    }
    return json_pack("{s:o}", "planes", list);
}

void visibility_print(const struct plant *plant, const struct visibility *visibility, json_t *into)
{
    json_object_set_new(into, "hidden", print_set(plant, &visibility->hidden));
    json_object_set_new(into, "isolate", print_set(plant, &visibility->isolated));
    json_object_set_new(into, "ghost", print_set(plant, &visibility->ghosts));
    json_object_set_new(into, "clip", print_clip(&visibility->clip));
}
