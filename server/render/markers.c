/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Markers by a compute shader that looks at the depth buffer. */
#include "render/markers.h"

#include <math.h>

#include "base/mem.h"
#include "render/matrix.h"

/* Of the shown group, on an asset that is not hidden, and not cut away. */
static bool is_shown(const struct picture *picture, const struct scene_sensor *sensor)
{
    const struct visibility *visibility = &picture->view->visibility;
    const struct plant_tag *tag = &picture->stage->scene->plant->tags[sensor->tag];
    return tag->group == picture->view->field.group && visibility_of(visibility, tag->asset) != ASSET_HIDDEN &&
           clip_keeps(&visibility->clip, sensor->surface_m);
}

static size_t count_shown(const struct picture *picture)
{
    const struct scene *scene = picture->stage->scene;
    size_t count = 0;
    for (size_t a = 0; a < scene->asset_count; a++)
        for (size_t s = 0; s < scene->assets[a].sensor_count; s++)
            count += is_shown(picture, &scene->assets[a].sensors[s]);
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
    const struct scene *scene = picture->stage->scene;
    for (size_t a = 0; a < scene->asset_count; a++)
        for (size_t s = 0; s < scene->assets[a].sensor_count; s++) {
            const struct scene_sensor *sensor = &scene->assets[a].sensors[s];
            if (!is_shown(picture, sensor))
                continue;
            for (int c = 0; c < 3; c++)
                (*places)[c] = (float)(sensor->surface_m[c] - picture->shot.eye_m[c]);
            (*places++)[3] = (float)markers_slack_m(&scene->assets[a]);
        }
}

bool markers_start(struct sights *sights, const struct picture *picture)
{
    size_t count = count_shown(picture);
    if (count == 0)
        return true;
    float(*places)[4] = sights_fit(sights, picture->stage->gl->log, count);
    if (!places)
        return false;
    fill_places(picture, places);
    return sights_start(sights, picture, count);
}

static void give(const struct picture *picture, float (*places)[4], size_t count, struct frame *frame)
{
    const struct scene *scene = picture->stage->scene;
    frame->markers = mem_array(count, sizeof(*frame->markers));
    for (size_t a = 0; a < scene->asset_count; a++)
        for (size_t s = 0; s < scene->assets[a].sensor_count; s++) {
            const struct scene_sensor *sensor = &scene->assets[a].sensors[s];
            const float *place = places[frame->marker_count];
            if (is_shown(picture, sensor))
                frame->markers[frame->marker_count++] =
                    (struct frame_marker){ .tag = sensor->tag, .x_px = place[0], .y_px = place[1], .occluded = place[2] > 0.5f };
        }
}

void markers_get(const struct sights *sights, const struct picture *picture, struct frame *frame)
{
    size_t count = count_shown(picture);
    if (count > 0)
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
    for (int c = 0; c < 3; c++) {
        eye[c] = place[c];
        near[c] = place[c] * (1 - fmin(place[3] / length, 0.5));
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
