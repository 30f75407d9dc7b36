/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clients/web/app/input/approach.js does the same for the page. */
#include "view_sight.h"

#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "view_pane.h"

static const int64_t ANSWER_NS = 700 * NS_PER_MS, SEARCH_NS = 1500 * NS_PER_MS;
static const double NEAR_M = 0.05, /* what is hit there is the sensor's own surface */
    BEFORE = 0.9;                  /* of the way to the place */
enum { TRIES = 3 };

static struct camera camera_of(const struct view_pane *pane, const struct model *model)
{
    const struct view_sight *sight = &pane->sight;
    return approach_camera(&sight->first, model->plant.tags[sight->tag].position_m, sight->side);
}

static void ask(struct view_pane *pane, const struct model *model)
{
    struct view_sight *sight = &pane->sight;
    const double *around = sight->around < 0 ? (double[2]){ 0, 0 } : approach_around[sight->around];
    struct camera camera = camera_of(pane, model);
    double x, y;
    if (!view_pane_project_by(pane, &camera, model->plant.tags[sight->tag].position_m, &x, &y)) {
        sight->looks = false;
        return;
    }
    x = fmin(fmax(x + around[0] * pane->height_px, 0.5), pane->width_px - 0.5);
    y = fmin(fmax(y + around[1] * pane->height_px, 0.5), pane->height_px - 0.5);
    sight->asked_ns = clock_mono_ns();
    link_post(pane->link, json_pack("{s:s,s:I,s:f,s:f,s:o}", "type", "pick", "seq", (json_int_t)++sight->seq, "x", x, "y", y, "camera",
                                    view_pane_camera_message(&camera)));
}

static void end(struct view_pane *pane, const struct model *model)
{
    struct view_sight *sight = &pane->sight;
    sight->looks = false;
    sight->side = sight->best;
    if (sight->best > 0) {
        struct camera camera = camera_of(pane, model);
        view_pane_look(pane, &camera);
    }
}

static void next_side(struct view_pane *pane, const struct model *model)
{
    struct view_sight *sight = &pane->sight;
    bool late = clock_mono_ns() - sight->begun_ns > SEARCH_NS; /* on a slow network what was found until then will do */
    sight->side++;
    sight->around = -1;
    sight->tries = 0;
    if (sight->side == APPROACH_SIDES || (sight->best >= 0 && sight->least_covered == 0) || (late && (sight->best >= 0 || sight->behind)))
        end(pane, model);
    else
        ask(pane, model);
}

void view_sight_begin(struct view_pane *pane, const struct model *model, int tag, const struct camera *first)
{
    uint32_t seq = pane->sight.seq;
    pane->sight = (struct view_sight){ .tag = tag, .first = *first, .around = -1, .best = -1, .seq = seq, .begun_ns = clock_mono_ns() };
    pane->sight.looks = model->plant.tags[tag].has_position && model->plant.tags[tag].asset >= 0;
    if (pane->sight.looks)
        ask(pane, model);
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

static void hear_middle(struct view_pane *pane, const struct model *model, const json_t *picked, bool is_other)
{
    struct view_sight *sight = &pane->sight;
    const struct plant_tag *tag = &model->plant.tags[sight->tag];
    const char *sensor = json_string_value(json_object_get(picked, "sensor"));
    bool is_marked = sensor && !strcmp(sensor, tag->name) && !json_is_true(json_object_get(picked, "occluded"));
    if (is_marked || distance_m(picked, tag->position_m) < NEAR_M) {
        sight->covered = sight->around = sight->tries = 0;
        ask(pane, model);
        return;
    }
    sight->behind |= is_other;
    next_side(pane, model);
}

void view_sight_hear(struct view_pane *pane, const struct model *model, const json_t *picked)
{
    struct view_sight *sight = &pane->sight;
    if (!sight->looks || json_integer_value(json_object_get(picked, "seq")) != (json_int_t)sight->seq)
        return;
    const struct plant_tag *tag = &model->plant.tags[sight->tag];
    const char *asset = json_string_value(json_object_get(picked, "asset"));
    bool is_other = asset && strcmp(asset, model->plant.assets[tag->asset].id) != 0;
    if (sight->around < 0) {
        hear_middle(pane, model, picked, is_other);
        return;
    }
    struct camera camera = camera_of(pane, model);
    double far_m = sqrt(pow(camera.eye_m[0] - tag->position_m[0], 2) + pow(camera.eye_m[1] - tag->position_m[1], 2) +
                        pow(camera.eye_m[2] - tag->position_m[2], 2));
    sight->covered += is_other && distance_m(picked, camera.eye_m) < BEFORE * far_m;
    sight->tries = 0;
    bool is_worse = sight->best >= 0 && sight->covered >= sight->least_covered;
    if (++sight->around < APPROACH_AROUND && !is_worse) {
        ask(pane, model);
        return;
    }
    if (!is_worse) {
        sight->best = sight->side;
        sight->least_covered = sight->covered;
    }
    next_side(pane, model);
}

void view_sight_tick(struct view_pane *pane, const struct model *model, int64_t now_ns)
{
    struct view_sight *sight = &pane->sight;
    if (!sight->looks || now_ns - sight->asked_ns < ANSWER_NS)
        return;
    if (++sight->tries < TRIES)
        ask(pane, model);
    else
        end(pane, model);
}
