/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clients/web/app/input/approach.js does the same for the page. */
#include "view_sight.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "view_address.h"

static const int64_t ANSWER_NS = 700 * NS_PER_MS, SEARCH_NS = 1500 * NS_PER_MS;
static const double NEAR_M = 0.05, /* what is hit there is the sensor's own surface */
    BEFORE = 0.9;                  /* of the way to the place */
enum { TRIES = 3, MOST_SEEN_THROUGH = 4 };

static struct camera camera_of(const struct view_sight *sight)
{
    return approach_camera(&sight->first, sight->place_m, sight->side);
}

static void ask(struct view_sight *sight, struct link *link)
{
    static const double middle[2] = { 0, 0 };
    const double *around = sight->around < 0 ? middle : approach_around[sight->around];
    struct camera camera = camera_of(sight);
    double x = fmin(fmax(sight->x_px + around[0] * sight->height_px, 0.5), sight->width_px - 0.5);
    double y = fmin(fmax(sight->y_px + around[1] * sight->height_px, 0.5), sight->height_px - 0.5);
    sight->asked_ns = clock_mono_ns();
    link_post(link, json_pack("{s:s,s:I,s:f,s:f,s:o}", "type", "pick", "seq", (json_int_t)++sight->seq, "x", x, "y", y, "camera",
                              view_address_camera_message(&camera)));
}

/* --- through what stands before it --------------------------------------------------------------------------------------------- */

static bool is_in(const json_t *ids, const char *id)
{
    for (size_t i = 0; i < json_array_size(ids); i++)
        if (!strcmp(json_string_value(json_array_get(ids, i)), id))
            return true;
    return false;
}

/* That many of those that were made, and what the view has anyway. */
static void set_ghosts(struct view_sight *sight, struct link *link, int count)
{
    if (count == 0 && sight->made_count == 0)
        return;
    json_t *all = json_array();
    sight->made_count = count;
    json_array_extend(all, sight->ghosts);
    for (int i = 0; i < count; i++)
        json_array_append_new(all, json_string(sight->made[i]));
    link_post(link, json_pack("{s:s,s:I,s:o}", "type", "params", "seq", (json_int_t)(*sight->params_seq += 1), "ghost", all));
}

static bool look_through_next(struct view_sight *sight, struct link *link)
{
    set_ghosts(sight, link, 0);
    if (++sight->through == sight->behind_count || sight->through == MOST_SEEN_THROUGH) {
        sight->looks = false;
        return false;
    }
    sight->side = sight->behind[sight->through];
    sight->around = -1;
    sight->tries = 0;
    ask(sight, link);
    return false;
}

/* What was asked is what is in front from that side, with the ghosts that were made so far. */
static bool hear_through(struct view_sight *sight, struct link *link, const char *asset, bool is_seen, struct camera *out)
{
    if (is_seen) {
        sight->looks = false;
        *out = camera_of(sight);
        return sight->side > 0;
    }
    bool known = !asset || !strcmp(asset, sight->asset) || is_in(sight->ghosts, asset);
    for (int i = 0; i < sight->made_count && !known; i++)
        known = !strcmp(asset, sight->made[i]);
    if (known || sight->made_count == SIGHT_GHOSTS)
        return look_through_next(sight, link);
    snprintf(sight->made[sight->made_count], sizeof(sight->made[0]), "%s", asset);
    set_ghosts(sight, link, sight->made_count + 1);
    sight->tries = 0;
    ask(sight, link);
    return false;
}

/* --- sides ------------------------------------------------------------------------------------------------------------------------- */

static bool end(struct view_sight *sight, struct link *link, struct camera *out)
{
    if (sight->best < 0)
        return look_through_next(sight, link);
    sight->looks = false;
    sight->side = sight->best;
    if (sight->best > 0)
        *out = camera_of(sight);
    return sight->best > 0;
}

static bool next_side(struct view_sight *sight, struct link *link, struct camera *out)
{
    bool late = clock_mono_ns() - sight->begun_ns > SEARCH_NS; /* on a slow network what was found until then will do */
    sight->side++;
    sight->around = -1;
    sight->tries = 0;
    if (sight->side == APPROACH_SIDES || (sight->best >= 0 && sight->least_covered == 0) ||
        (late && (sight->best >= 0 || sight->behind_count > 0)))
        return end(sight, link, out);
    ask(sight, link);
    return false;
}

void view_sight_begin(struct view_sight *sight, struct link *link)
{
    sight->looks = true;
    sight->side = sight->tries = 0;
    sight->around = sight->best = sight->through = -1;
    sight->behind_count = sight->made_count = 0;
    sight->begun_ns = clock_mono_ns();
    ask(sight, link);
}

void view_sight_end(struct view_sight *sight)
{
    sight->looks = false;
}

void view_sight_finish(struct view_sight *sight)
{
    json_decref(sight->ghosts);
    *sight = (struct view_sight){ 0 };
}

/* How far from there the hit is; infinite: nothing was hit. */
static double distance_m(const json_t *picked, const double from_m[3])
{
    const json_t *at = json_object_get(picked, "position");
    double sum = 0;
    for (size_t i = 0; i < 3; i++)
        sum += pow(json_number_value(json_array_get(at, i)) - from_m[i], 2);
    return json_array_size(at) == 3 ? sqrt(sum) : INFINITY;
}

static bool shows_place(const struct view_sight *sight, const json_t *picked)
{
    const char *sensor = json_string_value(json_object_get(picked, "sensor"));
    bool is_marked = sensor && !strcmp(sensor, sight->tag) && !json_is_true(json_object_get(picked, "occluded"));
    return is_marked || distance_m(picked, sight->place_m) < NEAR_M;
}

static bool hear_middle(struct view_sight *sight, struct link *link, bool is_seen, bool is_other, struct camera *out)
{
    if (is_seen) {
        sight->covered = sight->around = sight->tries = 0;
        ask(sight, link);
        return false;
    }
    if (is_other)
        sight->behind[sight->behind_count++] = sight->side;
    return next_side(sight, link, out);
}

bool view_sight_hear(struct view_sight *sight, struct link *link, const json_t *picked, struct camera *out)
{
    if (!sight->looks || json_integer_value(json_object_get(picked, "seq")) != (json_int_t)sight->seq)
        return false;
    const char *asset = json_string_value(json_object_get(picked, "asset"));
    bool is_other = asset && strcmp(asset, sight->asset) != 0;
    if (sight->through >= 0)
        return hear_through(sight, link, asset, shows_place(sight, picked), out);
    if (sight->around < 0)
        return hear_middle(sight, link, shows_place(sight, picked), is_other, out);
    struct camera camera = camera_of(sight);
    double far_m = 0;
    for (int i = 0; i < 3; i++)
        far_m += pow(camera.eye_m[i] - sight->place_m[i], 2);
    sight->covered += is_other && distance_m(picked, camera.eye_m) < BEFORE * sqrt(far_m);
    sight->tries = 0;
    bool is_worse = sight->best >= 0 && sight->covered >= sight->least_covered;
    if (++sight->around < APPROACH_AROUND && !is_worse) {
        ask(sight, link);
        return false;
    }
    if (!is_worse) {
        sight->best = sight->side;
        sight->least_covered = sight->covered;
    }
    return next_side(sight, link, out);
}

bool view_sight_tick(struct view_sight *sight, struct link *link, int64_t now_ns, struct camera *out)
{
    if (!sight->looks || now_ns - sight->asked_ns < ANSWER_NS)
        return false;
    if (++sight->tries >= TRIES && sight->through >= 0)
        return look_through_next(sight, link);
    if (sight->tries >= TRIES) { /* what was found until then, and nothing is seen through */
        sight->behind_count = 0;
        return end(sight, link, out);
    }
    ask(sight, link);
    return false;
}
