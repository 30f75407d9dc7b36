/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clients/web/app/input/approach.js does the same for the page. */
#include "view_sight.h"

#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "view_address.h"

static const int64_t ANSWER_NS = 700 * NS_PER_MS, SEARCH_NS = 1500 * NS_PER_MS;
static const double NEAR_M = 0.05, /* what is hit there is the sensor's own surface */
    BEFORE = 0.9;                  /* of the way to the place */
enum { TRIES = 3 };

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

static bool end(struct view_sight *sight, struct camera *out)
{
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
    if (sight->side == APPROACH_SIDES || (sight->best >= 0 && sight->least_covered == 0) || (late && (sight->best >= 0 || sight->behind)))
        return end(sight, out);
    ask(sight, link);
    return false;
}

void view_sight_begin(struct view_sight *sight, struct link *link)
{
    sight->looks = true;
    sight->side = sight->tries = 0;
    sight->around = sight->best = -1;
    sight->behind = false;
    sight->begun_ns = clock_mono_ns();
    ask(sight, link);
}

void view_sight_end(struct view_sight *sight)
{
    sight->looks = false;
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

static bool hear_middle(struct view_sight *sight, struct link *link, const json_t *picked, bool is_other, struct camera *out)
{
    const char *sensor = json_string_value(json_object_get(picked, "sensor"));
    bool is_marked = sensor && !strcmp(sensor, sight->tag) && !json_is_true(json_object_get(picked, "occluded"));
    if (is_marked || distance_m(picked, sight->place_m) < NEAR_M) {
        sight->covered = sight->around = sight->tries = 0;
        ask(sight, link);
        return false;
    }
    sight->behind |= is_other;
    return next_side(sight, link, out);
}

bool view_sight_hear(struct view_sight *sight, struct link *link, const json_t *picked, struct camera *out)
{
    if (!sight->looks || json_integer_value(json_object_get(picked, "seq")) != (json_int_t)sight->seq)
        return false;
    const char *asset = json_string_value(json_object_get(picked, "asset"));
    bool is_other = asset && strcmp(asset, sight->asset) != 0;
    if (sight->around < 0)
        return hear_middle(sight, link, picked, is_other, out);
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
    if (++sight->tries >= TRIES)
        return end(sight, out);
    ask(sight, link);
    return false;
}
