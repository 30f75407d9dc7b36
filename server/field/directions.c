/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Interpolates directions (directions.h): converts the sensors' readings and directions to vectors, and sums the vectors at
   points of the surface. */
#include "field/directions.h"

#include <math.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "field/layout.h"
#include "value/quality.h"

#define AT_ONE_PLACE 1e-6 /* metres; a point nearer than this to a sensor counts as being at the sensor */
/* smallest component of a sensor's vector along the surface, as a fraction of its length: a vector more perpendicular to the
   surface has no known direction there */
#define MIN_TANGENT_PART 0.1

static const float *angles_of(const struct field_layout *layout)
{
    const struct influence_view *view = &layout->file->influence;
    const struct influence_entry *entry = layout->assumed ? NULL : influence_find(view, layout->number, INFLUENCE_TRANSPORT);
    return entry && entry->sensor_count == layout->sensor_count ? influence_array(view, entry->shares) : NULL;
}

/* --- readings --------------------------------------------------------------------------------------------------------------- */

/* Converts a bearing (degrees clockwise from north, seen from above) to a unit vector of the plant. North is +Y, or -Z in a
   plant whose up axis is Y. */
static void from_bearing(const struct plant *plant, double degrees, double out[3])
{
    double east = sin(degrees * M_PI / 180), north = cos(degrees * M_PI / 180);
    out[0] = east;
    out[1] = plant->up == AXIS_Y ? 0 : north;
    out[2] = plant->up == AXIS_Y ? -north : 0;
}

static struct sensor_direction read_one(const struct scene *scene, int asset, const struct plant_tag *tag, const struct reading *own,
                                        const struct snapshot *snapshot)
{
    struct sensor_direction out = { .configured = tag->direction.count > 0 };
    double said[3] = { 0 }, vector[3];
    const double *m = scene->assets[asset].placement;
    out.known = out.configured && !quality_is_bad(own->quality) && isfinite(own->value);
    out.uncertain = quality_is_uncertain(own->quality);
    for (int i = 0; i < tag->direction.count; i++) {
        const struct reading *reading = &snapshot->readings[tag->direction.tags[i]];
        out.known &= !quality_is_bad(reading->quality) && isfinite(reading->value);
        out.uncertain |= quality_is_uncertain(reading->quality);
        said[i] = reading->value;
    }
    if (!out.known)
        return out;
    if (tag->direction.count == 1)
        from_bearing(scene->plant, said[0], said);
    out.known = vec_normalize(said) > 0 || own->value == 0;
    for (int c = 0; c < 3; c++)
        vector[c] = own->value * (m[4 * c] * said[0] + m[4 * c + 1] * said[1] + m[4 * c + 2] * said[2]);
    for (int c = 0; c < 3; c++)
        out.vector[c] = (float)vector[c];
    return out;
}

size_t directions_read(const struct scene *scene, int asset, int group, const struct snapshot *snapshot, struct sensor_direction **out)
{
    *out = NULL;
    struct field_layout *layout = scene->plant->groups[group].directed ? layout_create(scene, asset, group, NULL) : NULL;
    size_t count = 0;
    if (layout && angles_of(layout)) {
        count = layout->sensor_count;
        *out = mem_array(count, sizeof(**out));
        for (size_t i = 0; i < count; i++) {
            int tag = layout->sensors[i].tag;
            (*out)[i] = read_one(scene, asset, &scene->plant->tags[tag], &snapshot->readings[tag], snapshot);
        }
    }
    layout_destroy(&layout);
    return count;
}

/* --- finding directions at positions on the surface ------------------------------------------------------------------------- */

/* A sensor's vector, projected onto the surface. `turn`: its angle to the sensor's reference vector, which parallel transport
   moves along the surface; `length`: its length. */
struct spread {
    double turn, length;
    bool configured, known, uncertain;
};

static struct spread spread_of(const struct field_layout *layout, const float *angles, size_t sensor, const struct sensor_direction *said)
{
    const uint32_t vertex = layout->sensors[sensor].vertex;
    const float *normal_f = layout->file->view.normals[vertex], start = angles[sensor * layout->vertex_count + vertex];
    double normal[3], x[3], y[3], vector[3];
    for (int c = 0; c < 3; c++) {
        normal[c] = (double)normal_f[c];
        vector[c] = (double)said->vector[c];
    }
    vec_normalize(normal);
    vec_frame(normal, x, y);
    double whole = vec_length(vector), along = hypot(vec_dot(vector, x), vec_dot(vector, y));
    return (struct spread){ .turn = atan2(vec_dot(vector, y), vec_dot(vector, x)) - (double)start,
                            .length = whole,
                            .configured = said->configured,
                            .known = said->known && isfinite(start) && along >= MIN_TANGENT_PART * whole,
                            .uncertain = said->uncertain };
}

/* Computes the sensor's reference unit vector at the point, after parallel transport along the surface. Returns false if no
   path leads to the point. */
static bool carry(const struct field_layout *layout, const float *angles, double turn, const struct direction_place *place, double out[3])
{
    double normal[3];
    for (int c = 0; c < 3; c++) {
        out[c] = 0;
        normal[c] = (double)place->normal[c];
    }
    for (int i = 0; i < 3; i++) {
        const float *of = layout->file->view.normals[place->corners[i]];
        double at[3] = { (double)of[0], (double)of[1], (double)of[2] }, x[3], y[3], v[3], angle = turn + (double)angles[place->corners[i]];
        if (!isfinite(angle) || place->weights[i] <= 0)
            continue;
        vec_normalize(at);
        vec_frame(at, x, y);
        for (int c = 0; c < 3; c++)
            v[c] = (double)place->weights[i] * (cos(angle) * x[c] + sin(angle) * y[c]);
        vec_turn(v, at, normal);
        for (int c = 0; c < 3; c++)
            out[c] += v[c];
    }
    return vec_normalize(out) > 0;
}

static double strength_of(const struct field_layout *layout, const struct field_params *params, size_t sensor)
{
    const struct field_override *override = field_params_override_of(params, layout->sensors[sensor].tag);
    return (double)(override && override->strength >= 0 ? override->strength : layout->sensors[sensor].strength);
}

static struct direction find_one(const struct field_layout *layout, const float *angles, const struct field_params *params,
                                 const struct spread *spreads, const struct direction_place *place)
{
    struct direction out = { 0 };
    double sum[3] = { 0 }, whole = 0, unsure = 0, nearest_m = INFINITY, lost_m = INFINITY, v[3];
    double power = params->interpolation == INTERPOLATION_SHEPARD ? params->power : 2;
    struct layout_point point;
    float room;
    layout_point_init(&point, layout, place->corners, place->weights);
    for (size_t i = 0; i < layout->sensor_count; i++) {
        double away_m = spreads[i].configured ? (double)*layout_distances(&point.layout, field_params_distance(params), i, 0, 1, &room)
                                              : (double)INFINITY;
        if (!(away_m <= params->reach_m) || !isfinite(away_m) || strength_of(layout, params, i) <= 0)
            continue;
        away_m = max_of(away_m, AT_ONE_PLACE);
        if (!spreads[i].known || !carry(layout, angles + i * layout->vertex_count, spreads[i].turn, place, v)) {
            lost_m = min_of(lost_m, away_m);
            continue;
        }
        double fades = isfinite(params->reach_m) ? 1 - away_m / params->reach_m : 1;
        double weight = strength_of(layout, params, i) * pow(away_m, -power) * fades * fades * spreads[i].length;
        nearest_m = min_of(nearest_m, away_m);
        whole += weight;
        unsure += spreads[i].uncertain ? weight : 0;
        for (int c = 0; c < 3; c++)
            sum[c] += weight * v[c];
    }
    double length = vec_normalize(sum);
    out.known = nearest_m <= lost_m && length > 0 && length >= DIRECTION_LEAST * whole;
    out.uncertain = unsure >= 0.5 * whole && whole > 0;
    for (int c = 0; c < 3; c++)
        out.along[c] = out.known ? (float)sum[c] : 0;
    return out;
}

void directions_find(const struct direction_sources *sources, const struct direction_place *places, size_t count, struct direction *out)
{
    struct field_layout *layout = layout_create(sources->scene, sources->asset, sources->params->group, NULL);
    const float *angles = layout ? angles_of(layout) : NULL;
    bool good = angles && layout->sensor_count == sources->sensor_count;
    struct spread *spreads = mem_array(sources->sensor_count, sizeof(*spreads));
    for (size_t i = 0; good && i < sources->sensor_count; i++)
        spreads[i] = spread_of(layout, angles, i, &sources->sensors[i]);
    for (size_t p = 0; p < count; p++)
        out[p] = good ? find_one(layout, angles, sources->params, spreads, &places[p]) : (struct direction){ 0 };
    mem_free(spreads);
    layout_destroy(&layout);
}
