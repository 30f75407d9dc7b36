/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Evaluates a field (values interpolated between sensors) at one point, as a sum over all its sensors, from straight-line
   distances (pixel_field.h). */
#include "field/pixel_field.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "base/mem.h"
#include "field/weight_formula.h"

struct nearest { /* metres; INFINITY: there is none */
    float used, lost, no_limits;
};

static float distance_of(const struct pixel_sensor *sensor, const float point_m[3])
{
    float square = 0;
    for (int c = 0; c < 3; c++)
        square += (point_m[c] - sensor->place_m[c]) * (point_m[c] - sensor->place_m[c]);
    return sqrtf(square);
}

static struct nearest nearest_of(const struct pixel_field *field, const float point_m[3])
{
    struct nearest nearest = { INFINITY, INFINITY, INFINITY };
    for (int i = 0; i < field->count; i++) {
        uint32_t state = field->sensors[i].state;
        float *to = state & PIXEL_USABLE ? &nearest.used : state & PIXEL_NO_LIMITS ? &nearest.no_limits : &nearest.lost;
        *to = fminf(*to, distance_of(&field->sensors[i], point_m));
    }
    return nearest;
}

/* Returns a sensor's weight at a point; *term receives the factor with which the sensor's value enters the sum. near_log2: log2
   of near_m, the distance to the nearest sensor. top: for the interpolation `paper`, the largest exponent of all sensors at
   this point, which prevents overflow. */
static float weight_of(const struct pixel_field *field, const struct pixel_sensor *sensor, float distance_m, float near_m, float near_log2,
                       float top, float *term)
{
    float weight, d;
    if (field->paper) {
        float exponent = weight_exponent(distance_m, field->radius_m, 1 / field->radius_m, sensor->strength, &d) - top;
        weight = weight_exp2(exponent);
        *term = sensor->decay == 0 ? weight : weight_raised(exponent, d, sensor->decay);
    } else {
        weight = sensor->strength * (field->power == 2 ? weight_part_squared(distance_m, near_m)
                                                       : weight_part(distance_m, near_m, near_log2, field->power));
        *term = weight;
    }
    if (field->reach_m < INFINITY) {
        weight = weight_faded(weight, distance_m, near_m, field->reach_m);
        *term = weight_faded(*term, distance_m, near_m, field->reach_m);
    }
    return weight;
}

static void sum(const struct pixel_field *field, const float point_m[3], float near_m, struct pixel_value *out)
{
    float top = 0, near_log2 = weight_log2(near_m), d;
    double values = 0, total = 0, marked = 0;
    for (int i = 0; i < field->count && field->paper; i++) {
        const struct pixel_sensor *sensor = &field->sensors[i];
        float distance_m = distance_of(sensor, point_m);
        if (sensor->state & PIXEL_USABLE && weight_takes_part(distance_m, near_m, field->reach_m))
            top = fmaxf(top, weight_exponent(distance_m, field->radius_m, 1 / field->radius_m, sensor->strength, &d));
    }
    for (int i = 0; i < field->count; i++) {
        const struct pixel_sensor *sensor = &field->sensors[i];
        float term;
        if (!(sensor->state & PIXEL_USABLE))
            continue;
        double weight = (double)weight_of(field, sensor, distance_of(sensor, point_m), near_m, near_log2, top, &term);
        total += weight;
        marked += sensor->state & PIXEL_UNCERTAIN ? weight : 0;
        values += (double)term * (double)sensor->value;
    }
    out->uncertain = marked > 0 && 2 * marked >= total;
    out->value = total > 0 ? fminf(fmaxf((float)(values / total) * field->scale + field->offset, field->low), field->high) : field->empty;
}

void pixel_field_at(const struct pixel_field *field, const float point_m[3], struct pixel_value *out)
{
    struct nearest nearest = nearest_of(field, point_m);
    *out = (struct pixel_value){ .value = nearest.used };
    if (field->show == PIXEL_DISTANCE)
        return;
    sum(field, point_m, nearest.used, out);
    if (field->show == PIXEL_BLIND)
        out->value = fminf(field->seen * expf(nearest.used / field->hot_spot_m * (nearest.used / field->hot_spot_m) / 2), field->most);
    out->no_limits = nearest.no_limits < nearest.used && nearest.no_limits <= nearest.lost && nearest.no_limits <= field->reach_m;
    bool reached = nearest.used <= field->reach_m && nearest.used < INFINITY, lost = nearest.lost < nearest.used;
    out->no_data = !out->no_limits && !(reached && (!lost || field->fill));
    out->uncertain |= reached && lost && field->fill && field->show != PIXEL_BLIND;
}

/* Returns the largest change of a reading, which bounds the change of any value: shepard's values are weighted means of
   readings, and paper's values change by no more than the readings do. */
float pixel_field_change(const struct pixel_field *field, const struct pixel_field *before)
{
    struct pixel_field same = *before;
    float most = 0;
    same.low = field->low;
    same.high = field->high;
    if (memcmp(&same, field, offsetof(struct pixel_field, sensors)) != 0)
        return INFINITY;
    for (int i = 0; i < field->count; i++) {
        struct pixel_sensor sensor = before->sensors[i];
        sensor.value = field->sensors[i].value;
        if (memcmp(&sensor, &field->sensors[i], sizeof(sensor)) != 0)
            return INFINITY;
        most = fmaxf(most, fabsf(sensor.value - before->sensors[i].value) * field->scale);
    }
    return most;
}

void pixel_field_copy(struct pixel_field *to, const struct pixel_field *from)
{
    mem_free(to->sensors);
    *to = *from;
    to->sensors = mem_array((size_t)from->count, sizeof(*to->sensors));
    if (from->count > 0)
        memcpy(to->sensors, from->sensors, (size_t)from->count * sizeof(*to->sensors));
}

void pixel_field_finish(struct pixel_field *field)
{
    mem_free(field->sensors);
    memset(field, 0, sizeof(*field));
}

uint64_t pixel_field_hash(const struct pixel_field *field)
{
    return XXH3_64bits_withSeed(field->sensors, (size_t)field->count * sizeof(*field->sensors),
                                XXH3_64bits(field, offsetof(struct pixel_field, sensors)));
}
