/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Markers by a compute shader that looks at the depth buffer. */
#include "render/markers.h"

#include <math.h>

#include "base/mem.h"
#include "render/matrix.h"

bool marker_next(struct marker_walk *walk, struct marker_place *out)
{
    for (; walk->asset < walk->scene->asset_count; walk->asset++, walk->sensor = 0)
        while (walk->sensor < walk->scene->assets[walk->asset].sensor_count) {
            const struct scene_sensor *sensor = &walk->scene->assets[walk->asset].sensors[walk->sensor++];
            *out = (struct marker_place){ sensor->tag, (int)walk->asset, sensor->surface_m };
            if (!trial_find(walk->trial, sensor->tag))
                return true;
        }
    if (!walk->trial || walk->tried == walk->trial->count)
        return false;
    const struct trial_sensor *sensor = &walk->trial->sensors[walk->tried++];
    *out = (struct marker_place){ sensor->tag, sensor->asset, sensor->place_m };
    return true;
}

/* Of the shown group, on an asset that is not hidden, and not cut away. */
bool marker_is_shown(const struct scene *scene, const struct view *view, const struct marker_place *place)
{
    return scene->plant->tags[place->tag].group == view->field.group && visibility_of(&view->visibility, place->asset) != ASSET_HIDDEN &&
           clip_keeps(&view->visibility.clip, place->surface_m);
}

static struct marker_walk walk_of(const struct picture *picture, const struct trial **trial)
{
    *trial = field_take_trial(picture->field, &picture->view->field);
    return (struct marker_walk){ .scene = picture->stage->scene, .trial = *trial };
}

/* The next of those that are shown. */
static bool next_shown(struct marker_walk *walk, const struct picture *picture, struct marker_place *place)
{
    while (marker_next(walk, place))
        if (marker_is_shown(walk->scene, picture->view, place))
            return true;
    return false;
}

static size_t count_shown(const struct picture *picture)
{
    const struct trial *trial;
    struct marker_walk walk = walk_of(picture, &trial);
    struct marker_place place;
    size_t count = 0;
    while (next_shown(&walk, picture, &place))
        count++;
    field_give_trial(picture->field, &trial);
    return count;
}

double markers_slack_m(const struct scene_asset *asset)
{
    double size = 0;
    for (int c = 0; c < 3; c++)
        size = fmax(size, asset->bounds_max_m[c] - asset->bounds_min_m[c]);
    return fmin(fmax(0.01 * size, 0.005), 0.10);
}

static void fill_places(const struct picture *picture, float (*places)[4])
{
    const struct trial *trial;
    struct marker_walk walk = walk_of(picture, &trial);
    struct marker_place place;
    for (; next_shown(&walk, picture, &place); places++) {
        for (int c = 0; c < 3; c++)
            (*places)[c] = (float)(place.surface_m[c] - picture->shot.eye_m[c]);
        (*places)[3] = (float)markers_slack_m(&walk.scene->assets[place.asset]);
    }
    field_give_trial(picture->field, &trial);
}

bool markers_start(struct sights *sights, const struct picture *picture)
{
    size_t count = count_shown(picture);
    if (count == 0)
        return true;
    float(*places)[4] = sights_fit(sights, picture->stage->gl, count);
    if (!places)
        return false;
    fill_places(picture, places);
    return sights_start(sights, picture, count);
}

/* NULL: it does not stand on that asset, or is tried out elsewhere. */
static const struct scene_sensor *standing(const struct marker_walk *walk, int asset, int tag)
{
    const struct scene_asset *on = &walk->scene->assets[asset];
    for (size_t i = 0; i < on->sensor_count && !trial_find(walk->trial, tag); i++)
        if (on->sensors[i].tag == tag)
            return &on->sensors[i];
    return NULL;
}

/* From the sensor that distances are shown of. NAN: it stands on another asset, there is no way, or the way is not known yet. */
static double distance_m(const struct marker_walk *walk, const struct marker_place *place, const struct field_params *params)
{
    const struct trial_sensor *tried = trial_find(walk->trial, params->sensor);
    const struct trial_sensor *tried_to = trial_find(walk->trial, place->tag);
    const struct scene_sensor *from = standing(walk, place->asset, params->sensor), *to = standing(walk, place->asset, place->tag);
    const struct asset_view *file = &walk->scene->assets[place->asset].file->view;
    if ((!from && !tried) || (tried && tried->asset != place->asset))
        return NAN;
    if (place->tag == params->sensor)
        return 0;
    if (params->distance == DISTANCE_EUCLIDEAN) {
        const double *a = tried ? tried->place_m : from->surface_m, *b = place->surface_m;
        return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
    }
    const float *along_m = tried ? trial_distances(tried) : file->geodesic_m + (size_t)from->column * file->header->vertex_count;
    uint32_t vertex = tried_to ? tried_to->vertex : file->sensors[to->column].nearest_vertex;
    double away_m = along_m ? (double)along_m[vertex] : INFINITY;
    return away_m < 1e30 ? away_m : NAN;
}

static void give(const struct picture *picture, float (*places)[4], size_t count, struct frame *frame)
{
    const struct trial *trial;
    struct marker_walk walk = walk_of(picture, &trial);
    struct marker_place place;
    frame->markers = mem_array(count, sizeof(*frame->markers));
    while (frame->marker_count < count && next_shown(&walk, picture, &place)) {
        const float *at = places[frame->marker_count];
        struct frame_marker *marker = &frame->markers[frame->marker_count++];
        *marker = (struct frame_marker){ .tag = place.tag, .x_px = at[0], .y_px = at[1], .occluded = at[2] > 0.5f };
        if (picture->view->field.show == SHOW_DISTANCE)
            marker->value = distance_m(&walk, &place, &picture->view->field);
    }
    field_give_trial(picture->field, &trial);
}

void markers_get(const struct sights *sights, const struct picture *picture, struct frame *frame)
{
    size_t count = count_shown(picture);
    if (count > 0 && count <= sights->capacity) /* a trial may have gone since it was started */
        give(picture, sights->places, count, frame);
}

/* --- without GL ------------------------------------------------------------------------------------------------------------- */

/* The farthest depth around a pixel. */
static float farthest_near(const float *depth, size_t pitch_px, int width_px, int height_px, int x, int y)
{
    float farthest = 1;
    for (int v = y - 1; v <= y + 1; v++)
        for (int u = x - 1; u <= x + 1; u++) {
            int column = u < 0 ? 0 : u < width_px ? u : width_px - 1, row = v < 0 ? 0 : v < height_px ? v : height_px - 1;
            farthest = fminf(farthest, depth[(size_t)row * pitch_px + (size_t)column]);
        }
    return farthest;
}

void markers_look(const struct picture *picture, const float *depth, size_t pitch_px, float place[4])
{
    int width_px = picture->view->width_px, height_px = picture->view->height_px;
    double eye[3], near[3], clip[4], near_clip[4];
    double length = fmax(sqrt((double)(place[0] * place[0] + place[1] * place[1] + place[2] * place[2])), 1e-6);
    bool parallel = picture->shot.pixel_per_metre > 0;
    for (int c = 0; c < 3; c++) {
        eye[c] = place[c];
        near[c] = parallel ? place[c] + picture->shot.back[c] * place[3] : place[c] * (1 - fmin(place[3] / length, 0.5));
    }
    matrix_point(picture->shot.clip_from_eye, eye, clip);
    matrix_point(picture->shot.clip_from_eye, near, near_clip);
    bool hidden = clip[3] <= 0;
    double x = hidden ? -1e4 : (0.5 + 0.5 * clip[0] / clip[3]) * width_px;
    double y = hidden ? -1e4 : (0.5 - 0.5 * clip[1] / clip[3]) * height_px;
    hidden = hidden || x < 0 || y < 0 || x >= width_px || y >= height_px ||
             near_clip[2] / near_clip[3] < farthest_near(depth, pitch_px, width_px, height_px, (int)x, (int)y);
    place[0] = (float)x;
    place[1] = (float)y;
    place[2] = hidden;
}

void markers_find(const struct picture *picture, const float *depth, size_t pitch_px, struct frame *frame)
{
    size_t count = count_shown(picture);
    if (count == 0)
        return;
    float(*places)[4] = mem_array(count, sizeof(*places));
    fill_places(picture, places);
    for (size_t i = 0; i < count; i++)
        markers_look(picture, depth, pitch_px, places[i]);
    give(picture, places, count, frame);
    mem_free(places);
}
