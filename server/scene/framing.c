/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Standard views of the plant, an asset or a sensor. */
#include "scene/framing.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"

/* Tilt from the vertical of the views straight down and straight up, as a tangent. In an exactly vertical view, north would
 * have no direction in the picture. With the tilt, the camera's up vector stays the plant's, and orbiting continues smoothly.
 * */
static const double VERTICAL_TILT = 1e-3;
static const double DEFAULT_ASPECT = 16 / 9.0; /* aspect ratio that the initial view in the plant file is made for */
/* side of the cube shown around a sensor, as a fraction of the longest side of the asset's bounding box */
static const double SENSOR_PART = 0.35;
static const double SENSOR_MIN_M = 0.3, SENSOR_MAX_M = 3; /* limits in metres on the side of the cube shown around a sensor */
/* elevation angle of the camera above a sensor that it looks at, as a tangent */
static const double SENSOR_RISE = 0.36;

static const struct scene_sensor *find_sensor(const struct scene_asset *asset, int tag)
{
    for (size_t i = 0; i < asset->sensor_count; i++)
        if (asset->sensors[i].tag == tag)
            return &asset->sensors[i];
    return NULL;
}

bool framing_find(const struct plant *plant, const char *name, struct framing *framing)
{
    *framing = (struct framing){ .asset = -1, .tag = -1 };
    if (!name)
        return true;
    framing->asset = plant_find_asset(plant, name);
    if (framing->asset >= 0)
        return true;
    int tag = plant_find_tag(plant, name);
    if (tag >= 0 && plant->tags[tag].asset >= 0)
        framing->tag = tag;
    return framing->tag >= 0;
}

/* Writes the unit vectors towards east, north and up in the plant frame. */
static void compass(const struct scene *scene, double east[3], double north[3], double up[3])
{
    bool y_up = scene->plant->up == AXIS_Y;
    memcpy(east, (double[3]){ 1, 0, 0 }, 3 * sizeof(*east));
    memcpy(north, (double[3]){ 0, !y_up, y_up ? -1 : 0 }, 3 * sizeof(*north));
    memcpy(up, (double[3]){ 0, y_up, !y_up }, 3 * sizeof(*up));
}

static void side_forward(const struct scene *scene, enum side side, const struct camera *camera, double forward[3])
{
    static const double parts[][3] = { /* by side: components of the view direction along east, north and up */
                                       [SIDE_TOP] = { 0, VERTICAL_TILT, -1 },
                                       [SIDE_BOTTOM] = { 0, VERTICAL_TILT, 1 },
                                       [SIDE_FRONT] = { 0, 1, 0 },
                                       [SIDE_BACK] = { 0, -1, 0 },
                                       [SIDE_LEFT] = { 1, 0, 0 },
                                       [SIDE_RIGHT] = { -1, 0, 0 },
                                       [SIDE_ISO] = { -1, 1, -0.8165 }
    };
    double east[3], north[3], up[3];
    compass(scene, east, north, up);
    for (int i = 0; i < 3; i++)
        forward[i] = side == SIDE_NOW ? camera->target_m[i] - camera->eye_m[i]
                                      : parts[side][0] * east[i] + parts[side][1] * north[i] + parts[side][2] * up[i];
}

/* Computes the view direction onto a sensor: against the outward normal of the ellipsoid in the asset's box, slightly from above. */
static void sensor_forward(const struct scene_asset *asset, const double place_m[3], const double up[3], double forward[3])
{
    double out[3], rise = 0, length = 0;
    for (int i = 0; i < 3; i++) {
        double size_m = fmax(asset->bounds_max_m[i] - asset->bounds_min_m[i], 1e-3);
        out[i] = (place_m[i] - 0.5 * (asset->bounds_min_m[i] + asset->bounds_max_m[i])) / (size_m * size_m);
        rise += out[i] * up[i];
    }
    for (int i = 0; i < 3; i++) {
        out[i] -= rise * up[i];
        length += out[i] * out[i];
    }
    length = sqrt(length);
    for (int i = 0; i < 3 && length > 1e-9; i++)
        forward[i] = -out[i] / length - SENSOR_RISE * up[i];
}

static void sensor_box(const struct scene_asset *asset, const double place_m[3], double min_m[3], double max_m[3])
{
    double size_m = 0;
    for (int i = 0; i < 3; i++)
        size_m = fmax(size_m, asset->bounds_max_m[i] - asset->bounds_min_m[i]);
    size_m = fmin(fmax(SENSOR_PART * size_m, SENSOR_MIN_M), SENSOR_MAX_M);
    for (int i = 0; i < 3; i++) {
        min_m[i] = place_m[i] - 0.5 * size_m;
        max_m[i] = place_m[i] + 0.5 * size_m;
    }
}

void framing_look(const struct scene *scene, const struct framing *framing, double aspect, struct camera *camera)
{
    double min_m[3], max_m[3], forward[3], east[3], north[3], up[3];
    int index = framing->tag >= 0 ? scene->plant->tags[framing->tag].asset : framing->asset;
    const struct scene_sensor *sensor = framing->tag >= 0 ? find_sensor(&scene->assets[index], framing->tag) : NULL;
    const struct scene_asset *asset = index >= 0 ? &scene->assets[index] : NULL;
    memcpy(min_m, asset ? asset->bounds_min_m : scene->bounds_min_m, sizeof(min_m));
    memcpy(max_m, asset ? asset->bounds_max_m : scene->bounds_max_m, sizeof(max_m));
    side_forward(scene, framing->side, camera, forward);
    compass(scene, east, north, up);
    if (sensor) {
        sensor_box(asset, sensor->surface_m, min_m, max_m);
        if (framing->side == SIDE_NOW)
            sensor_forward(asset, sensor->surface_m, up, forward);
    }
    if (framing->side != SIDE_NOW)
        memcpy(camera->up, up, sizeof(up));
    if (index < 0 && scene->extreme_count > 0)
        camera_fit_points(camera, forward, (const double(*)[3])scene->extremes_m, scene->extreme_count, aspect, &framing->window);
    else
        camera_fit_along(camera, forward, min_m, max_m, aspect, &framing->window);
}

/* Returns whether the camera sees the point within a rectangular window of the picture. */
static bool sees(const struct camera *camera, double aspect, const struct camera_window *window, const double point_m[3])
{
    static const struct camera_window whole = { -1, 1, -1, 1 };
    double right[3], up[3], forward[3], x = 0, y = 0, depth_m = 0, tall = tan(camera->fov_deg * M_PI / 360);
    if (!(window->left < window->right && window->bottom < window->top))
        window = &whole;
    camera_basis(camera, right, up, forward);
    for (int i = 0; i < 3; i++) {
        double from_m = point_m[i] - camera->eye_m[i];
        x += right[i] * from_m;
        y += up[i] * from_m;
        depth_m += forward[i] * from_m;
    }
    x /= depth_m * tall * aspect;
    y /= depth_m * tall;
    return depth_m > 0 && x >= window->left && x <= window->right && y >= window->bottom && y <= window->top;
}

void framing_keep(const struct scene *scene, double aspect, const struct camera_window *window, struct camera *camera)
{
    size_t count = scene->extreme_count > 0 ? scene->extreme_count : 8, held = 0, seen = 0;
    double(*points_m)[3] = mem_array(count, sizeof(*points_m)), forward[3];
    for (size_t n = 0; n < count; n++) {
        double corner_m[3];
        for (int i = 0; i < 3; i++)
            corner_m[i] = n >> i & 1 ? scene->bounds_max_m[i] : scene->bounds_min_m[i];
        const double *point_m = scene->extreme_count > 0 ? scene->extremes_m[n] : corner_m;
        if (!sees(camera, DEFAULT_ASPECT, &(struct camera_window){ 0 }, point_m))
            continue;
        memcpy(points_m[held++], point_m, sizeof(*points_m));
        seen += sees(camera, aspect, window, point_m);
    }
    for (int i = 0; i < 3; i++)
        forward[i] = camera->target_m[i] - camera->eye_m[i];
    if (seen < held)
        camera_fit_points(camera, forward, (const double(*)[3])points_m, held, aspect, window);
    mem_free(points_m);
}
