/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Projects sensor markers and tests their visibility: by a compute shader on the depth buffer, or on the CPU. */
#include "render/pick/markers.h"

#include <math.h>

#include "base/mem.h"
#include "protocol/asset_distance.h"
#include "render/matrix.h"

bool marker_next(struct marker_iterator *iterator, struct marker_place *out)
{
    for (; iterator->asset < iterator->scene->asset_count; iterator->asset++, iterator->sensor = 0)
        while (iterator->sensor < iterator->scene->assets[iterator->asset].sensor_count) {
            const struct scene_sensor *sensor = &iterator->scene->assets[iterator->asset].sensors[iterator->sensor++];
            *out = (struct marker_place){ sensor->tag, (int)iterator->asset, sensor->surface_m };
            if (!trial_find(iterator->trial, sensor->tag))
                return true;
        }
    if (!iterator->trial || iterator->tried == iterator->trial->count)
        return false;
    const struct trial_sensor *sensor = &iterator->trial->sensors[iterator->tried++];
    *out = (struct marker_place){ sensor->tag, sensor->asset, sensor->place_m };
    return true;
}

/* Returns whether the sensor is in the shown group, its asset is not hidden, and no section plane cuts the asset away at the sensor. */
bool marker_is_shown(const struct scene *scene, const struct view *view, const struct marker_place *place)
{
    return scene->plant->tags[place->tag].group == view->field.group && visibility_of(&view->visibility, place->asset) != ASSET_HIDDEN &&
           clip_keeps(&view->visibility.clip, place->surface_m);
}

static struct marker_iterator iterator_of(const struct frame_context *context, const struct trial **trial)
{
    *trial = field_take_trial(context->field, &context->view->field);
    return (struct marker_iterator){ .scene = context->gpu_scene->scene, .trial = *trial };
}

/* Advances the iterator to the next sensor whose marker is shown. Returns false after the last one. */
static bool next_shown(struct marker_iterator *iterator, const struct frame_context *context, struct marker_place *place)
{
    while (marker_next(iterator, place))
        if (marker_is_shown(iterator->scene, context->view, place))
            return true;
    return false;
}

static size_t count_shown(const struct frame_context *context)
{
    const struct trial *trial;
    struct marker_iterator iterator = iterator_of(context, &trial);
    struct marker_place place;
    size_t count = 0;
    while (next_shown(&iterator, context, &place))
        count++;
    field_give_trial(context->field, &trial);
    return count;
}

double markers_slack_m(const struct scene_asset *asset)
{
    double size = 0;
    for (int c = 0; c < 3; c++)
        size = fmax(size, asset->bounds_max_m[c] - asset->bounds_min_m[c]);
    return fmin(fmax(0.01 * size, 0.005), 0.10);
}

static void fill_places(const struct frame_context *context, float (*places)[4])
{
    const struct trial *trial;
    struct marker_iterator iterator = iterator_of(context, &trial);
    struct marker_place place;
    for (; next_shown(&iterator, context, &place); places++) {
        for (int c = 0; c < 3; c++)
            (*places)[c] = (float)(place.surface_m[c] - context->constants.eye_m[c]);
        (*places)[3] = (float)markers_slack_m(&iterator.scene->assets[place.asset]);
    }
    field_give_trial(context->field, &trial);
}

bool markers_start(struct point_visibility *queries, const struct frame_context *context)
{
    size_t count = count_shown(context);
    if (count == 0)
        return true;
    float(*places)[4] = point_visibility_reserve(queries, context->gpu_scene->gl, count);
    if (!places)
        return false;
    fill_places(context, places);
    return point_visibility_start(queries, context, count);
}

/* Returns the sensor of a tag on this asset, at its configured position. NULL: the tag has no sensor there, or a user tries out
   another position for it. */
static const struct scene_sensor *sensor_on(const struct marker_iterator *iterator, int asset, int tag)
{
    const struct scene_asset *on = &iterator->scene->assets[asset];
    for (size_t i = 0; i < on->sensor_count && !trial_find(iterator->trial, tag); i++)
        if (on->sensors[i].tag == tag)
            return &on->sensors[i];
    return NULL;
}

/* Returns the marker's distance in metres from the sensor chosen in the view. NAN: the marker is on another asset, no path exists, or the
   distance is not computed yet. */
static double distance_m(const struct marker_iterator *iterator, const struct marker_place *place, const struct field_params *params)
{
    const struct trial_sensor *tried = trial_find(iterator->trial, params->sensor);
    const struct trial_sensor *tried_to = trial_find(iterator->trial, place->tag);
    const struct scene_sensor *from = sensor_on(iterator, place->asset, params->sensor);
    const struct scene_sensor *to = sensor_on(iterator, place->asset, place->tag);
    const struct asset_view *file = &iterator->scene->assets[place->asset].file->view;
    if ((!from && !tried) || (tried && tried->asset != place->asset))
        return NAN;
    if (place->tag == params->sensor)
        return 0;
    /* returns "unknown" if the view uses heat distances: the asset file has only the geodesic distances along triangles, which
       differ */
    if (params->distance == DISTANCE_HEAT)
        return NAN;
    if (params->distance == DISTANCE_EUCLIDEAN) {
        const double *a = tried ? tried->place_m : from->surface_m, *b = place->surface_m;
        return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
    }
    const float *tried_m = tried ? trial_distances(tried) : NULL;
    uint32_t vertex = tried_to ? tried_to->vertex : file->sensors[to->column].nearest_vertex;
    double away_m = tried_m ? (double)tried_m[vertex] : tried ? INFINITY : (double)asset_distance_m(file, from->column, vertex);
    return away_m < 1e30 ? away_m : NAN;
}

static void emit_markers(const struct frame_context *context, float (*places)[4], size_t count, struct frame *frame)
{
    const struct trial *trial;
    struct marker_iterator iterator = iterator_of(context, &trial);
    struct marker_place place;
    frame->markers = mem_array(count, sizeof(*frame->markers));
    while (frame->marker_count < count && next_shown(&iterator, context, &place)) {
        const float *at = places[frame->marker_count];
        struct frame_marker *marker = &frame->markers[frame->marker_count++];
        *marker = (struct frame_marker){ .tag = place.tag, .x_px = at[0], .y_px = at[1], .occluded = at[2] > 0.5f };
        if (context->view->field.show == SHOW_DISTANCE)
            marker->value = distance_m(&iterator, &place, &context->view->field);
    }
    field_give_trial(context->field, &trial);
}

void markers_measure(const struct frame_context *context, struct frame *frame)
{
    const struct trial *trial;
    struct marker_iterator iterator = iterator_of(context, &trial);
    struct marker_place place;
    for (size_t i = 0; i < frame->marker_count && next_shown(&iterator, context, &place); i++)
        frame->markers[i].value = context->view->field.show == SHOW_DISTANCE ? distance_m(&iterator, &place, &context->view->field) : 0;
    field_give_trial(context->field, &trial);
}

void markers_get(const struct point_visibility *queries, const struct frame_context *context, struct frame *frame)
{
    size_t count = count_shown(context);
    /* ignores the visibility test if its buffer is too small for the markers shown now: a trial (sensors moved on the model)
       has ended since the test began */
    if (count > 0 && count <= queries->capacity)
        emit_markers(context, queries->places, count, frame);
}

/* --- without GL ------------------------------------------------------------------------------------------------------------- */

/* Returns the farthest depth in the depth buffer among the 3x3 pixels around a pixel. A marker is hidden only if it is behind
   all of these. */
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

void markers_look(const struct frame_context *context, const float *depth, size_t pitch_px, float place[4])
{
    int width_px = context->view->width_px, height_px = context->view->height_px;
    double eye[3], near[3], clip[4], near_clip[4];
    double length = fmax(sqrt((double)(place[0] * place[0] + place[1] * place[1] + place[2] * place[2])), 1e-6);
    bool parallel = context->constants.pixel_per_metre > 0;
    for (int c = 0; c < 3; c++) {
        eye[c] = place[c];
        near[c] = parallel ? place[c] + context->constants.back[c] * place[3] : place[c] * (1 - fmin(place[3] / length, 0.5));
    }
    matrix_point(context->constants.clip_from_eye, eye, clip);
    matrix_point(context->constants.clip_from_eye, near, near_clip);
    bool hidden = clip[3] <= 0;
    double x = hidden ? -1e4 : (0.5 + 0.5 * clip[0] / clip[3]) * width_px;
    double y = hidden ? -1e4 : (0.5 - 0.5 * clip[1] / clip[3]) * height_px;
    hidden = hidden || x < 0 || y < 0 || x >= width_px || y >= height_px ||
             near_clip[2] / near_clip[3] < farthest_near(depth, pitch_px, width_px, height_px, (int)x, (int)y);
    place[0] = (float)x;
    place[1] = (float)y;
    place[2] = hidden;
}

void markers_find(const struct frame_context *context, const float *depth, size_t pitch_px, struct frame *frame)
{
    size_t count = count_shown(context);
    if (count == 0)
        return;
    float(*places)[4] = mem_array(count, sizeof(*places));
    fill_places(context, places);
    for (size_t i = 0; i < count; i++)
        markers_look(context, depth, pitch_px, places[i]);
    emit_markers(context, places, count, frame);
    mem_free(places);
}
