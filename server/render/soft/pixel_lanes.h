/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Evaluates a field of straight-line distances (field/pixel_field.h) at eight points at a time. Private to soft/. */
#ifndef RENDER_SOFT_PIXEL_LANES_H
#define RENDER_SOFT_PIXEL_LANES_H
#include <math.h>

#include "render/soft/pixel_lists.h"

struct eight_values {
    lanes value;
    lanes_int no_data, uncertain, no_limits; /* -1: yes */
};

/* squared distance in m^2 to the nearest sensor of each state: used: its reading counts; lost: it has no usable reading; no_limits: it has
   no alarm limits. PIXEL_FAR2: there is no sensor of that state */
struct eight_nearest {
    lanes used, lost, no_limits;
};
#define PIXEL_FAR2 1e30f

SOFT_INLINE const struct pixel_sensor *pixel_listed(const struct pixel_field *field, const struct pixel_list *list, int i)
{
    return &field->sensors[list->sensors ? list->sensors[i] : (uint32_t)i];
}

SOFT_INLINE lanes pixel_square(const struct pixel_sensor *sensor, const lanes at[3])
{
    lanes x = at[0] - sensor->place_m[0], y = at[1] - sensor->place_m[1], z = at[2] - sensor->place_m[2];
    return x * x + y * y + z * z;
}

/* Returns, for each of eight points, three squared distances to sensors of the list: to the nearest one whose reading is used,
   the nearest one without a usable reading (lost), and the nearest one without alarm limits. */
SOFT_INLINE struct eight_nearest pixel_nearest(const struct pixel_field *field, const struct pixel_list *list, const lanes at[3])
{
    lanes far2 = (lanes){ 0 } + PIXEL_FAR2;
    struct eight_nearest nearest = { far2, far2, far2 };
    for (int i = 0; i < list->count; i++) {
        const struct pixel_sensor *sensor = pixel_listed(field, list, i);
        lanes *to = sensor->state & PIXEL_USABLE ? &nearest.used : sensor->state & PIXEL_NO_LIMITS ? &nearest.no_limits : &nearest.lost;
        *to = lanes_least(pixel_square(sensor, at), *to);
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

/* Returns the factor that lowers a sensor's weight to 0 at the end of its reach: ((reach - distance) / (reach - near))^2, where
   `near` is the distance of the nearest sensor. Beyond the reach it is 0. */
SOFT_INLINE lanes pixel_fade(const struct pixel_field *field, lanes square, lanes near2)
{
    lanes none = { 0 }, one = none + 1.0f, distance = lanes_root(square);
    lanes_int nearest = square <= near2, within = distance < field->reach_m;
    lanes left = (field->reach_m - distance) / lanes_choose(nearest, one, field->reach_m - lanes_root(near2));
    return lanes_choose(nearest, one, lanes_choose(within, left * left, none));
}

/* Returns the value of a list's polynomial `of` (struct pixel_list) at eight points. u: vectors from the list's centre to the points, in
   metres. */
SOFT_INLINE lanes pixel_polynomial(const float of[PIXEL_TERMS], const lanes u[3])
{
    lanes x = u[0] * (of[1] + u[0] * of[4] + u[1] * of[5] + u[2] * of[6]);
    return of[0] + x + u[1] * (of[2] + u[1] * of[7] + u[2] * of[8]) + u[2] * (of[3] + u[2] * of[9]);
}

/* Adds the polynomials that replace a list's far sensors to the sums of weights and of weighted values. part: for each point,
   the factor that converts the polynomials to the unit of the weights at that point (2^top / unit). */
SOFT_INLINE void pixel_add_far(const struct pixel_field *field, const struct pixel_list *list, const lanes at[3], lanes near2, lanes part,
                               struct eight_sums *sums)
{
    lanes u[3], none = { 0 };
    for (int c = 0; c < 3; c++)
        u[c] = at[c] - list->centre[c];
    if (field->reach_m < INFINITY) {
        lanes left = 1.0f - lanes_root(near2) * (1.0f / field->reach_m);
        part = lanes_choose(left > 1e-6f, part / (left * left), none);
    }
    sums->total += part * pixel_polynomial(list->total, u);
    sums->values += part * pixel_polynomial(list->values, u);
    if (list->has_marks)
        sums->marked += part * pixel_polynomial(list->marked, u);
}

SOFT_INLINE void pixel_sum_shepard(const struct pixel_field *field, const struct pixel_list *list, const lanes at[3], lanes near2,
                                   struct eight_sums *sums)
{
    lanes near_log2 = { 0 };
    if (field->power != 2.0f || list->has_far)
        near_log2 = lanes_log2(near2);
    for (int i = 0; i < list->count; i++) {
        const struct pixel_sensor *sensor = pixel_listed(field, list, i);
        if (!(sensor->state & PIXEL_USABLE))
            continue;
        lanes square = pixel_square(sensor, at), weight = pixel_part(field, square, near2, near_log2) * sensor->strength;
        if (field->reach_m < INFINITY)
            weight *= pixel_fade(field, square, near2);
        pixel_add(sensor, weight, weight, sums);
    }
    if (list->has_far)
        pixel_add_far(field, list, at, near2, lanes_exp2(0.5f * field->power * near_log2 + list->top), sums);
}

/* Sums the weights 1 / distance^2 of a list of sensors that all have a usable reading. Unlike other kinds of weights, these need not be
   scaled by the nearest sensor's weight: they fit into a float even at a sensor. */
SOFT_INLINE void pixel_sum_inverse_square(const struct pixel_field *field, const struct pixel_list *list, const lanes at[3],
                                          struct eight_sums *sums)
{
    const lanes least = (lanes){ 0 } + 1e-24f;
    for (int i = 0; i < list->count; i++) {
        const struct pixel_sensor *sensor = pixel_listed(field, list, i);
        lanes weight = sensor->strength / lanes_most(pixel_square(sensor, at), least);
        pixel_add(sensor, weight, weight, sums);
    }
    if (list->has_far)
        pixel_add_far(field, list, at, least, (lanes){ 0 } + list->unit, sums);
}

/* For the interpolation `paper` (Algorithm 1 of Kim & Suh): returns the exponent of the sensor's weight. *near receives the
   nearness to the sensor: 1 at the sensor, 0 at the radius R and beyond. */
SOFT_INLINE lanes pixel_exponent(const struct pixel_field *field, const struct pixel_sensor *sensor, lanes square, lanes *near)
{
    const float per_radius = 1.0f / field->radius_m;
    *near = lanes_most((field->radius_m - lanes_root(square)) * per_radius, (lanes){ 0 });
    return *near * (sensor->strength * 1.44269504f);
}

SOFT_INLINE void pixel_sum_paper(const struct pixel_field *field, const struct pixel_list *list, const lanes at[3], lanes near2,
                                 struct eight_sums *sums)
{
    lanes none = { 0 }, top = none, near;
    const bool reaches = field->reach_m < INFINITY;
    for (int i = 0; i < list->count; i++) {
        const struct pixel_sensor *sensor = pixel_listed(field, list, i);
        if (!(sensor->state & PIXEL_USABLE))
            continue;
        lanes square = pixel_square(sensor, at), exponent = pixel_exponent(field, sensor, square, &near);
        if (reaches)
            exponent = lanes_choose(pixel_fade(field, square, near2) > 0.0f, exponent, none);
        top = lanes_most(exponent, top);
    }
    for (int i = 0; i < list->count; i++) {
        const struct pixel_sensor *sensor = pixel_listed(field, list, i);
        if (!(sensor->state & PIXEL_USABLE))
            continue;
        lanes square = pixel_square(sensor, at), counts = reaches ? pixel_fade(field, square, near2) : none + 1.0f;
        lanes below = lanes_least(pixel_exponent(field, sensor, square, &near) - top, none);
        lanes weight = counts * lanes_exp2_down(below), term;
        if (sensor->decay == 1.0f)
            term = weight * near;
        else if (sensor->decay == 0.0f) /* 0^0 is 1 */
            term = weight;
        else
            term = lanes_choose(near > 1e-30f, counts * lanes_exp2_down(below + sensor->decay * lanes_log2(near)), none);
        pixel_add(sensor, weight, term, sums);
    }
    if (list->has_far)
        pixel_add_far(field, list, at, near2, lanes_exp2(list->top - top), sums);
}

SOFT_INLINE void pixel_value_of(const struct pixel_field *field, const struct eight_sums *sums, struct eight_values *out)
{
    lanes none = { 0 };
    lanes_int any = sums->total > 0.0f;
    lanes value = sums->values / lanes_choose(any, sums->total, none + 1.0f) * field->scale + field->offset;
    out->value = lanes_choose(any, lanes_clamp(value, field->low, field->high), none + field->empty);
    out->uncertain = (sums->marked > 0.0f) & (2.0f * sums->marked >= sums->total);
}

/* Evaluates the field at eight points. at: x, y, z in the coordinates of sensors[].place_m. list: sensors to sum, and polynomials of the
   others. */
SOFT_INLINE void pixel_lanes_at(const struct pixel_field *field, const struct pixel_list *list, const lanes at[3], struct eight_values *out)
{
    lanes none = { 0 };
    const lanes_int no = { 0 };
    *out = (struct eight_values){ none, no, no, no };
    if (list->all_used && list->count > 0 && field->show == PIXEL_SUM && pixel_is_inverse_square(field)) {
        struct eight_sums sums = { none, none, none };
        pixel_sum_inverse_square(field, list, at, &sums);
        pixel_value_of(field, &sums, out);
        return;
    }
    struct eight_nearest nearest = pixel_nearest(field, list, at);
    if (field->show == PIXEL_DISTANCE) {
        out->value = lanes_root(nearest.used);
        return;
    }
    struct eight_sums sums = { none, none, none };
    if (field->paper)
        pixel_sum_paper(field, list, at, nearest.used, &sums);
    else
        pixel_sum_shepard(field, list, at, nearest.used, &sums);
    const float reach2 = field->reach_m < 1e15f ? field->reach_m * field->reach_m : 0.5f * PIXEL_FAR2;
    lanes_int reached = nearest.used <= reach2, lost = nearest.lost < nearest.used;
    pixel_value_of(field, &sums, out);
    /* The blind-spot view shows how much hotter than its surroundings a spot centred here must be, so that the nearest sensor
       detects it: field->seen * e^((d/s)^2 / 2), limited to field->most. d: distance to that sensor; s: field->hot_spot_m,
       the standard deviation of its Gaussian shape; seen: the smallest excess that a sensor detects at its own position */
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
