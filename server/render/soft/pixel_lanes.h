/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The field of few sensors (field/pixel_field.h) at eight places at a time. Private to soft/. */
#ifndef RENDER_SOFT_PIXEL_LANES_H
#define RENDER_SOFT_PIXEL_LANES_H
#include <math.h>

#include "field/pixel_field.h"
#include "render/soft/lanes.h"

struct eight_values {
    lanes value;
    lanes_int no_data, uncertain, no_limits; /* -1: yes */
};

/* squared distance, m^2, to the nearest sensor of each state: used: its reading counts; lost: no usable reading; no_limits: no alarm
   limits. PIXEL_FAR2: no sensor has that state */
struct eight_nearest {
    lanes used, lost, no_limits;
};
#define PIXEL_FAR2 1e30f

/* 2^x for x <= 0. Returns 1 at 0, and 0 below -126. Same polynomial as exp2_down() in field/kernels.c. */
SOFT_INLINE lanes lanes_exp2_down(lanes x)
{
    x = lanes_most(x, (lanes){ 0 } - 127.0f);
    lanes_int whole = lanes_whole(x - 0.5f);
    lanes f = x - __builtin_convertvector(whole, lanes);
    lanes p = f * 0.0013407237129285932f + 0.009671861305832863f;
    p = p * f + 0.055503085255622864f;
    p = p * f + 0.24022234976291656f;
    p = p * f + 0.6931472420692444f;
    p = p * f + 1.0f;
    return p * (lanes)((whole + 127) * (1 << 23));
}

/* Writes the squared distance of each sensor to `square`. Returns the smallest one for each state of a sensor. */
SOFT_INLINE struct eight_nearest pixel_distances(const struct pixel_field *field, const lanes at[3], lanes square[EXACT_SENSORS])
{
    lanes far2 = (lanes){ 0 } + PIXEL_FAR2;
    struct eight_nearest nearest = { far2, far2, far2 };
    for (int i = 0; i < field->count; i++) {
        const struct pixel_sensor *sensor = &field->sensors[i];
        lanes x = at[0] - sensor->place_m[0], y = at[1] - sensor->place_m[1], z = at[2] - sensor->place_m[2];
        square[i] = x * x + y * y + z * z;
        lanes *to = sensor->state & PIXEL_USABLE ? &nearest.used : sensor->state & PIXEL_NO_LIMITS ? &nearest.no_limits : &nearest.lost;
        *to = lanes_least(square[i], *to);
    }
    return nearest;
}

struct eight_sums {
    lanes values, total, marked;
};

SOFT_INLINE void pixel_add(const struct pixel_sensor *sensor, lanes weight, lanes term, struct eight_sums *sums)
{
    sums->values += sensor->value * term;
    sums->total += weight;
    if (sensor->state & PIXEL_UNCERTAIN)
        sums->marked += weight;
}

/* Returns the Shepard weight of a sensor relative to the nearest one: (distance of the nearest / distance)^power, which is 1 for the
   nearest. square, near2: squared distances. */
SOFT_INLINE lanes pixel_part(const struct pixel_field *field, lanes square, lanes near2, lanes near_log2)
{
    lanes one = (lanes){ 0 } + 1.0f, part;
    lanes_int nearest = square <= near2;
    if (field->power == 2.0f)
        part = near2 / lanes_choose(nearest, one, square);
    else
        part = lanes_exp2_down(lanes_least(0.5f * field->power * (near_log2 - lanes_log2(square)), (lanes){ 0 }));
    return lanes_choose(nearest, one, part);
}

/* Returns the factor that lowers a sensor's weight to 0 at the end of its reach: ((reach - distance) / (reach - distance of the nearest
   sensor))^2. Beyond the reach it is 0. */
SOFT_INLINE lanes pixel_fade(const struct pixel_field *field, lanes square, lanes near2)
{
    lanes none = { 0 }, one = none + 1.0f, distance = lanes_root(square);
    lanes_int nearest = square <= near2, within = distance < field->reach_m;
    lanes left = (field->reach_m - distance) / lanes_choose(nearest, one, field->reach_m - lanes_root(near2));
    return lanes_choose(nearest, one, lanes_choose(within, left * left, none));
}

SOFT_INLINE void pixel_sum_shepard(const struct pixel_field *field, const lanes square[], lanes near2, struct eight_sums *sums)
{
    lanes near_log2 = { 0 };
    if (field->power != 2.0f)
        near_log2 = lanes_log2(near2);
    for (int i = 0; i < field->count; i++) {
        const struct pixel_sensor *sensor = &field->sensors[i];
        if (!(sensor->state & PIXEL_USABLE))
            continue;
        lanes weight = pixel_part(field, square[i], near2, near_log2) * sensor->strength;
        if (field->reach_m < INFINITY)
            weight *= pixel_fade(field, square[i], near2);
        pixel_add(sensor, weight, weight, sums);
    }
}

SOFT_INLINE void pixel_sum_paper(const struct pixel_field *field, const lanes square[], lanes near2, struct eight_sums *sums)
{
    const float per_radius = 1.0f / field->radius_m;
    lanes none = { 0 }, top = none, d[EXACT_SENSORS], counts[EXACT_SENSORS];
    for (int i = 0; i < field->count; i++) {
        const struct pixel_sensor *sensor = &field->sensors[i];
        if (!(sensor->state & PIXEL_USABLE))
            continue;
        d[i] = lanes_most((field->radius_m - lanes_root(square[i])) * per_radius, none);
        counts[i] = field->reach_m < INFINITY ? pixel_fade(field, square[i], near2) : none + 1.0f;
        top = lanes_most(lanes_choose(counts[i] > 0.0f, d[i] * (sensor->strength * 1.44269504f), none), top);
    }
    for (int i = 0; i < field->count; i++) {
        const struct pixel_sensor *sensor = &field->sensors[i];
        if (!(sensor->state & PIXEL_USABLE))
            continue;
        lanes below = lanes_least(d[i] * (sensor->strength * 1.44269504f) - top, none), weight = counts[i] * lanes_exp2_down(below), term;
        if (sensor->decay == 1.0f)
            term = weight * d[i];
        else if (sensor->decay == 0.0f) /* 0^0 is 1 */
            term = weight;
        else
            term = lanes_choose(d[i] > 1e-30f, counts[i] * lanes_exp2_down(below + sensor->decay * lanes_log2(d[i])), none);
        pixel_add(sensor, weight, term, sums);
    }
}

/* Evaluates the field at eight points. at: x, y, z in the coordinates of sensors[].place_m. */
SOFT_INLINE void pixel_lanes_at(const struct pixel_field *field, const lanes at[3], struct eight_values *out)
{
    lanes square[EXACT_SENSORS], none = { 0 };
    struct eight_nearest nearest = pixel_distances(field, at, square);
    const lanes_int no = { 0 };
    *out = (struct eight_values){ none, no, no, no };
    if (field->show == PIXEL_DISTANCE) {
        out->value = lanes_root(nearest.used);
        return;
    }
    struct eight_sums sums = { none, none, none };
    if (field->paper)
        pixel_sum_paper(field, square, nearest.used, &sums);
    else
        pixel_sum_shepard(field, square, nearest.used, &sums);
    const float reach2 = field->reach_m < 1e15f ? field->reach_m * field->reach_m : 0.5f * PIXEL_FAR2;
    lanes_int any = sums.total > 0.0f, reached = nearest.used <= reach2, lost = nearest.lost < nearest.used;
    lanes value = sums.values / lanes_choose(any, sums.total, none + 1.0f) * field->scale + field->offset;
    out->value = lanes_choose(any, lanes_clamp(value, field->low, field->high), none + field->empty);
    out->uncertain = (sums.marked > 0.0f) & (2.0f * sums.marked >= sums.total);
    /* seen * 2^(log2(e)/2 (near/s)^2), where near is the distance of the nearest sensor and s the size of a hot spot; the limit `most` caps
       the result */
    if (field->show == PIXEL_BLIND) {
        lanes down = nearest.used * (-0.72134752f / (field->hot_spot_m * field->hot_spot_m));
        out->value = lanes_least(field->seen / lanes_exp2_down(lanes_most(down, none - 100.0f)), none + field->most);
    }
    out->no_limits = (nearest.no_limits < nearest.used) & (nearest.no_limits <= nearest.lost) & (nearest.no_limits <= reach2);
    lanes_int filled = reached & lost & -(int32_t)(field->fill != 0);
    out->no_data = ~out->no_limits & ~((reached & ~lost) | filled);
    if (field->show != PIXEL_BLIND)
        out->uncertain |= filled;
}

#endif
