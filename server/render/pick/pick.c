/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Picks the asset and the field's value at a pixel: casts a ray from the eye and interpolates the field in the triangle hit. */
#include "render/pick/pick.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "render/pick/markers.h"
#include "scene/raycast.h"

static const double MARKER_PX = 9; /* maximum distance in pixels from a click to the marker that it picks */
/* within this distance from a sensor, in pixels or in metres (the larger one counts), a pick returns the sensor's measured
   value instead of an interpolated one */
static const double MEASURED_PX = 3, MEASURED_M = 0.005;

struct pick_spot { /* state of one pick */
    const struct scene *scene;
    const struct view *view; /* view of the half of the frame that contains the picked pixel */
    const struct snapshot *snapshot;
    struct raycast_hit hit;
    double meter_per_pixel; /* width of a pixel at the hit point, in metres */
};

/* --- which sensor's marker --------------------------------------------------------------------------------------------------- */

struct lens {
    /* right, up, forward: unit vectors of the camera. pixel_per_unit: pixels per metre; in a perspective view, at 1 m from the eye */
    double right[3], up[3], forward[3], pixel_per_unit;
};

static void lens_init(struct lens *lens, const struct view *view)
{
    const struct camera *camera = &view->camera;
    camera_basis(camera, lens->right, lens->up, lens->forward);
    lens->pixel_per_unit =
        camera->height_m > 0 ? view->height_px / camera->height_m : view->height_px / (2 * tan(camera->fov_deg * M_PI / 360));
}

/* Projects a point to pixels. Returns false if the point is behind the eye. */
static bool lens_project(const struct lens *lens, const struct view *view, const double place_m[3], double *x_px, double *y_px)
{
    double right = 0, up = 0, ahead = 0;
    for (int i = 0; i < 3; i++) {
        double from_eye = place_m[i] - view->camera.eye_m[i];
        right += from_eye * lens->right[i];
        up += from_eye * lens->up[i];
        ahead += from_eye * lens->forward[i];
    }
    double scale = view->camera.height_m > 0 ? lens->pixel_per_unit : lens->pixel_per_unit / ahead;
    *x_px = view->width_px / 2.0 + right * scale;
    *y_px = view->height_px / 2.0 - up * scale;
    return view->camera.height_m > 0 || ahead > 0;
}

static void ray_through(const struct view *view, double x_px, double y_px, struct ray *ray)
{
    ray_init(ray, &view->camera, (double)view->width_px / view->height_px, 2 * x_px / view->width_px - 1, 1 - 2 * y_px / view->height_px);
}

/* Returns whether a ray from the eye to the marker hits no surface before it reaches the marker. */
static bool in_sight(const struct pick_spot *spot, const struct marker_place *place, double x_px, double y_px)
{
    struct ray ray;
    struct raycast_hit hit;
    double ahead = 0, square = 0;
    ray_through(spot->view, x_px, y_px, &ray);
    raycast(spot->scene, &spot->view->visibility, &ray, &hit);
    for (int i = 0; i < 3; i++) {
        ahead += (place->surface_m[i] - ray.origin[i]) * ray.direction[i];
        square += ray.direction[i] * ray.direction[i];
    }
    return hit.asset < 0 || hit.t * sqrt(square) > ahead / sqrt(square) - markers_slack_m(&spot->scene->assets[place->asset]);
}

static void find_sensor(const struct pick_spot *spot, const struct trial *trial, double x_px, double y_px, struct pick *out)
{
    struct marker_iterator iterator = { .scene = spot->scene, .trial = trial };
    struct marker_place place;
    struct lens lens;
    double near_px = MARKER_PX * (spot->view->pixel_ratio > 0 ? spot->view->pixel_ratio : 1);
    /* smallest distance in pixels, among the markers tested so far, from the picked pixel to [0] a visible marker, [1] a hidden
       marker */
    double least[2] = { near_px, near_px };
    lens_init(&lens, spot->view);
    while (marker_next(&iterator, &place)) {
        double x, y;
        if (!marker_is_shown(spot->scene, spot->view, &place) || !lens_project(&lens, spot->view, place.surface_m, &x, &y))
            continue;
        double away = hypot(x - x_px, y - y_px);
        if (away >= least[0])
            continue;
        bool occluded = !in_sight(spot, &place, x, y);
        if (away >= least[occluded] || (occluded && least[0] < near_px))
            continue;
        least[occluded] = away;
        out->sensor = place.tag;
        out->sensor_occluded = occluded;
    }
}

/* --- value of the field at the pixel ----------------------------------------------------------------------------------------- */

static void insert(struct pick *out, const struct pick_sensor *sensor)
{
    int at = out->nearest_count;
    while (at > 0 && sensor->distance_m < out->nearest[at - 1].distance_m)
        at--;
    if (at == PICK_NEAREST)
        return;
    int last = out->nearest_count < PICK_NEAREST ? out->nearest_count++ : PICK_NEAREST - 1;
    memmove(&out->nearest[at + 1], &out->nearest[at], (size_t)(last - at) * sizeof(*sensor));
    out->nearest[at] = *sensor;
}

static void read_sensors(const struct pick_spot *spot, struct field *field, const struct field_params *params,
                         const struct field_place *place, struct pick *out)
{
    struct field_sensor *sensors = NULL;
    float radius_m;
    size_t count = field_sensors(field, spot->hit.asset, params, &sensors, &radius_m);
    float *distances_m = field_distances_at(field, spot->hit.asset, params, place);
    for (size_t i = 0; i < count; i++) {
        int tag = sensors[i].tag;
        const struct reading *reading = &spot->snapshot->readings[tag];
        double distance_m = (double)distances_m[i];
        if (sensors[i].usable && distance_m <= params->reach_m && isfinite(distance_m))
            insert(out,
                   &(struct pick_sensor){ .tag = tag, .distance_m = distance_m, .value = reading->value, .quality = reading->quality });
    }
    out->assumed = field_is_assumed(field, spot->hit.asset, params);
    mem_free(distances_m);
    mem_free(sensors);
}

static bool is_measured(const struct pick_spot *spot, const struct field_params *params, const struct pick *pick)
{
    return pick->state == PICK_BETWEEN && params->interpolation != INTERPOLATION_PAPER && params->show != SHOW_DISTANCE &&
           !field_params_cover(params) && pick->nearest_count > 0 && !pick->assumed &&
           pick->nearest[0].distance_m <= fmax(MEASURED_M, MEASURED_PX * spot->meter_per_pixel);
}

static void read_place_as(const struct pick_spot *spot, struct field *field, const struct field_params *params, struct pick *out)
{
    struct field_place place;
    struct field_point point;
    memcpy(place.corners, spot->hit.corners, sizeof(place.corners));
    memcpy(place.parts, spot->hit.weights, sizeof(place.parts));
    if (out->inside || !field_at(field, out->asset, params, spot->snapshot, &place, &point))
        return;
    out->state = point.no_data ? PICK_NO_DATA : PICK_BETWEEN;
    out->uncertain = point.uncertain;
    out->value = point.value;
    out->drawn_error = point.drawn_error;
    read_sensors(spot, field, params, &place, out);
    if (is_measured(spot, params, out))
        out->state = PICK_MEASURED;
}

static void read_place(const struct pick_spot *spot, struct field *field, struct pick *out)
{
    struct field_params params = spot->view->field;
    if (params.show == SHOW_OPERATOR && field_is_assumed(field, out->asset, &params)) {
        /* One sensor, chosen among those with limits, colours the asset. The pick states that sensor's reading, not its place between the
         * limits. */
        struct pick one = *out;
        read_place_as(spot, field, &params, &one);
        if (one.nearest_count > 0) {
            one.value = one.nearest[0].value;
            *out = one;
            return;
        }
    }
    if (params.show == SHOW_OPERATOR)
        params.show = SHOW_VALUE;
    read_place_as(spot, field, &params, out);
}

void pick_at(const struct scene *scene, struct field *field, const struct view *view, const struct snapshot *snapshot, double x_px,
             double y_px, struct pick *out)
{
    struct view half;
    bool right = view->split && x_px >= view_left_px(view);
    view_half(view, right, &half);
    x_px -= right ? view_left_px(view) : 0;
    struct pick_spot spot = { .scene = scene, .view = &half, .snapshot = snapshot };
    struct ray ray;
    *out = (struct pick){ .asset = -1, .sensor = -1, .value = NAN, .data_utc_ns = snapshot->taken_utc_ns };
    if (x_px < 0 || y_px < 0 || x_px >= half.width_px || y_px >= half.height_px)
        return;
    const struct trial *trial = field_take_trial(field, &half.field);
    find_sensor(&spot, trial, x_px, y_px, out);
    field_give_trial(field, &trial);
    ray_through(&half, x_px, y_px, &ray);
    raycast(scene, &half.visibility, &ray, &spot.hit);
    if (spot.hit.asset < 0)
        return;
    out->asset = spot.hit.asset;
    out->inside = spot.hit.inside;
    memcpy(out->normal, spot.hit.normal, sizeof(out->normal));
    for (int i = 0; i < 3; i++)
        out->position_m[i] = ray.origin[i] + spot.hit.t * ray.direction[i];
    bool parallel = half.camera.height_m > 0;
    double high_m = parallel ? half.camera.height_m : 2 * tan(half.camera.fov_deg * M_PI / 360) * spot.hit.t;
    spot.meter_per_pixel = high_m / half.height_px;
    read_place(&spot, field, out);
}
