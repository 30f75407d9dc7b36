/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Evaluates a pixel field at one point: sums over its few sensors. */
#include "field/pixel_field.h"

#include <math.h>
#include <string.h>

struct nearest { /* metres; INFINITY: there is none */
    float used, lost, no_limits;
};

static struct nearest nearest_of(const struct pixel_field *field, const float distance_m[])
{
    struct nearest nearest = { INFINITY, INFINITY, INFINITY };
    for (int i = 0; i < field->count; i++) {
        uint32_t state = field->sensors[i].state;
        float *to = state & PIXEL_USABLE ? &nearest.used : state & PIXEL_NO_LIMITS ? &nearest.no_limits : &nearest.lost;
        *to = fminf(*to, distance_m[i]);
    }
    return nearest;
}

static float nearness(const struct pixel_field *field, float distance_m)
{
    return fmaxf(0, (field->radius_m - distance_m) / field->radius_m);
}

/* Returns a sensor's weight. top: for paper, the largest exponent of all sensors at this point, which keeps expf() from overflowing. */
static float weight_of(const struct pixel_field *field, int sensor, float distance_m, float near_m, float top)
{
    float strength = field->sensors[sensor].strength, left = 1, part = 1;
    if (!(distance_m < field->reach_m || distance_m <= near_m))
        return 0;
    if (field->reach_m < INFINITY && distance_m > near_m)
        left = (field->reach_m - distance_m) / (field->reach_m - near_m);
    if (field->paper)
        return left * left * expf(nearness(field, distance_m) * strength - top);
    if (distance_m > near_m)
        part = powf(near_m / distance_m, field->power);
    return left * left * part * strength;
}

static void sum(const struct pixel_field *field, const float distance_m[], float near_m, struct pixel_value *out)
{
    float top = 0;
    double values = 0, total = 0, marked = 0;
    for (int i = 0; i < field->count && field->paper; i++)
        if (field->sensors[i].state & PIXEL_USABLE && (distance_m[i] < field->reach_m || distance_m[i] <= near_m))
            top = fmaxf(top, nearness(field, distance_m[i]) * field->sensors[i].strength);
    for (int i = 0; i < field->count; i++) {
        const struct pixel_sensor *sensor = &field->sensors[i];
        if (!(sensor->state & PIXEL_USABLE))
            continue;
        double weight = (double)weight_of(field, i, distance_m[i], near_m, top);
        total += weight;
        marked += sensor->state & PIXEL_UNCERTAIN ? weight : 0;
        values += weight * (double)sensor->value * (field->paper ? pow((double)nearness(field, distance_m[i]), (double)sensor->decay) : 1);
    }
    out->uncertain = marked > 0 && 2 * marked >= total;
    out->value = total > 0 ? fminf(fmaxf((float)(values / total) * field->scale + field->offset, field->low), field->high) : field->empty;
}

void pixel_field_at(const struct pixel_field *field, const float point_m[3], struct pixel_value *out)
{
    float distance_m[EXACT_SENSORS];
    for (int i = 0; i < field->count; i++) {
        float square = 0;
        for (int c = 0; c < 3; c++)
            square += (point_m[c] - field->sensors[i].place_m[c]) * (point_m[c] - field->sensors[i].place_m[c]);
        distance_m[i] = sqrtf(square);
    }
    struct nearest nearest = nearest_of(field, distance_m);
    *out = (struct pixel_value){ .value = nearest.used };
    if (field->show == PIXEL_DISTANCE)
        return;
    sum(field, distance_m, nearest.used, out);
    if (field->show == PIXEL_BLIND)
        out->value = fminf(field->seen * expf(nearest.used / field->hot_spot_m * (nearest.used / field->hot_spot_m) / 2), field->most);
    out->no_limits = nearest.no_limits < nearest.used && nearest.no_limits <= nearest.lost && nearest.no_limits <= field->reach_m;
    bool reached = nearest.used <= field->reach_m && nearest.used < INFINITY, lost = nearest.lost < nearest.used;
    out->no_data = !out->no_limits && !(reached && (!lost || field->fill));
    out->uncertain |= reached && lost && field->fill && field->show != PIXEL_BLIND;
}

/* Returns the largest change of a reading, which bounds the change of any value: shepard's values are weighted means of readings, and
   paper's values change by no more than the readings. */
float pixel_field_change(const struct pixel_field *field, const struct pixel_field *before)
{
    struct pixel_field same = *before;
    float most = 0;
    same.low = field->low;
    same.high = field->high;
    for (int i = 0; i < field->count && field->count == before->count; i++) {
        most = fmaxf(most, fabsf(field->sensors[i].value - before->sensors[i].value) * field->scale);
        same.sensors[i].value = field->sensors[i].value;
    }
    return memcmp(&same, field, sizeof(same)) == 0 ? most : INFINITY;
}
