/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the sensors' interpolation weights like server/field, and their deviation from linear interpolation between the
 * corners of triangles. */
#include "preprocess/subdivision/linear_error.h"

#include <math.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "plant/exact.h"
#include "plant/singles.h"

/* maximum amount, as a share of the value range, that is subtracted from an error because a coarse level may show the value of
   a point up to slack_m away */
#define MAX_SLACK (1 / 255.0)

static double factor_of(double x)
{
    return x > 0 && x < 1e4 ? x : x > 0 ? 1e4 : 0;
}

static void add_group(struct linear_error *linear, const struct plant *plant, int group, const struct plant_sensor *sensors)
{
    const struct plant_group *from = &plant->groups[group];
    struct linear_error_group *to = &linear->groups[linear->group_count];
    *to = (struct linear_error_group){ .radius_m = { from->radius_m, from->radius_m } };
    to->columns = mem_array(linear->sensor_count, sizeof(*to->columns));
    to->count = plant_placed_sensors(plant, sensors, linear->sensor_count, group, to->columns);
    if (to->count == 0 || plant_group_is_exact(from)) {
        mem_free(to->columns);
        return;
    }
    size_t padded = interp_padded(to->count);
    float *strength = mem_array(padded, sizeof(*strength)), *decay = mem_array(padded, sizeof(*decay));
    to->of = (struct interp_group){
        .strength = strength, .decay = decay, .power = (float)from->power, .reach_m = (float)from->reach_m, .count = padded
    };
    for (size_t i = 0; i < padded; i++) {
        const struct plant_tag *tag = i < to->count ? &plant->tags[sensors[to->columns[i]].tag] : NULL;
        strength[i] = tag ? (float)factor_of(tag->strength) : 0;
        decay[i] = tag ? (float)factor_of(tag->decay) : 1;
        to->of.decays |= decay[i] != 1;
    }
    to->in_a_row = to->columns[to->count - 1] - to->columns[0] == to->count - 1;
    to->papers = plant_cuts_for_paper(from, to->count);
    linear->group_count++;
    linear->share_count += (to->papers ? 4 : 2) * padded;
    linear->most_count = padded > linear->most_count ? padded : linear->most_count;
}

void linear_error_init(struct linear_error *linear, const struct plant *plant, const struct plant_sensor *sensors, size_t sensor_count,
                       const float (*places_m)[3])
{
    *linear = (struct linear_error){ .sensor_count = sensor_count };
    linear->groups = mem_array(plant->group_count, sizeof(*linear->groups));
    for (int axis = 0; axis < 3; axis++) {
        linear->axes_m[axis] = mem_array(interp_padded(sensor_count), sizeof(float));
        for (size_t i = 0; i < interp_padded(sensor_count); i++)
            linear->axes_m[axis][i] = i < sensor_count ? places_m[i][axis] : INFINITY;
    }
    for (size_t g = 0; g < plant->group_count; g++)
        add_group(linear, plant, (int)g, sensors);
}

void linear_error_finish(struct linear_error *linear)
{
    for (size_t g = 0; g < linear->group_count; g++) {
        mem_free(linear->groups[g].columns);
        mem_free((float *)linear->groups[g].of.strength);
        mem_free((float *)linear->groups[g].of.decay);
    }
    for (int axis = 0; axis < 3; axis++)
        mem_free(linear->axes_m[axis]);
    mem_free(linear->groups);
    *linear = (struct linear_error){ 0 };
}

void linear_error_set_radius(struct linear_error *linear, const float *const largest_m[2])
{
    for (size_t g = 0; g < linear->group_count; g++)
        for (int mode = 0; mode < 2; mode++) {
            struct linear_error_group *group = &linear->groups[g];
            double largest = 0;
            for (size_t i = 0; i < group->count; i++)
                largest = max_of(largest, (double)largest_m[mode][group->columns[i]]);
            if (!(group->radius_m[mode] > 0))
                group->radius_m[mode] = largest > 0 ? largest : 1;
        }
}

/* buffer for one distance per sensor: on the caller's stack for up to FEW sensors, else on the heap */
#define FEW 1024
struct corner_room {
    float few[FEW], *at;
};

static float *room_for(struct corner_room *room, size_t count)
{
    room->at = count <= FEW ? room->few : mem_array(count, sizeof(*room->at));
    return room->at;
}

static void room_finish(struct corner_room *room)
{
    if (room->at != room->few)
        mem_free(room->at);
}

/* Distances from a point to every sensor: along the surface (geodesic) and straight (Euclidean). */
struct distances {
    const float *of[2]; /* by enum distance_mode: distances from the sensors */
    struct corner_room straight_m, picked_m;
};

static void distances_init(struct distances *distances, const struct linear_error *linear, const float point_m[3], const float *geodesic_m)
{
    size_t all = interp_padded(linear->sensor_count);
    float *straight_m = room_for(&distances->straight_m, all);
    room_for(&distances->picked_m, linear->most_count);
    interp_euclidean(point_m, (const float *const *)linear->axes_m, all, straight_m);
    distances->of[DISTANCE_GEODESIC] = geodesic_m;
    distances->of[DISTANCE_EUCLIDEAN] = straight_m;
}

static void distances_finish(struct distances *distances)
{
    room_finish(&distances->straight_m);
    room_finish(&distances->picked_m);
}

/* Returns the distances from a point to a group's sensors, valid until the next call. Does not copy them if the sensors are
 * consecutive on the asset and need no padding. */
static const float *pick(const struct linear_error_group *group, struct distances *distances, int mode)
{
    const float *from = distances->of[mode];
    float *distance_m = distances->picked_m.at;
    if (group->in_a_row && group->count == group->of.count)
        return from + group->columns[0];
    if (group->in_a_row)
        memcpy(distance_m, from + group->columns[0], group->count * sizeof(*distance_m));
    for (size_t i = 0; i < group->count && !group->in_a_row; i++)
        distance_m[i] = from[group->columns[i]];
    for (size_t i = group->count; i < group->of.count; i++)
        distance_m[i] = INFINITY;
    return distance_m;
}

void linear_error_weights(const struct linear_error *linear, const float point_m[3], const float *geodesic_m, bool slopes, float *interp,
                          struct interp_norm *norms)
{
    float *slope = interp + linear->share_count;
    struct distances distances;
    distances_init(&distances, linear, point_m, geodesic_m);
    for (int mode = 0; mode < 2; mode++)
        for (size_t g = 0; g < linear->group_count; g++) {
            const struct linear_error_group *group = &linear->groups[g];
            const float *distance_m = pick(group, &distances, mode);
            float *of = slope;
            *slope++ = interp_shepard(&group->of, distance_m, slopes, interp, norms);
            interp += group->of.count;
            *slope++ = group->papers ? interp_paper(&group->of, (float)group->radius_m[mode], distance_m, interp) : 0;
            interp += group->papers ? group->of.count : 0;
            float beyond_m = norms++->near_m - group->of.reach_m;
            if (beyond_m > 0)
                of[0] = of[1] = -beyond_m;
        }
    distances_finish(&distances);
}

void linear_error_norms(const struct linear_error *linear, const float point_m[3], const float *geodesic_m, struct interp_norm *norms)
{
    struct distances distances;
    distances_init(&distances, linear, point_m, geodesic_m);
    for (int mode = 0; mode < 2; mode++)
        for (size_t g = 0; g < linear->group_count; g++) {
            const struct linear_error_group *group = &linear->groups[g];
            interp_shepard_norm(&group->of, pick(group, &distances, mode), norms++);
        }
    distances_finish(&distances);
}

void linear_error_weights_again(const struct linear_error *linear, const float point_m[3], const float *geodesic_m,
                                const struct interp_norm *norms, float *interp)
{
    struct distances distances;
    distances_init(&distances, linear, point_m, geodesic_m);
    for (int mode = 0; mode < 2; mode++)
        for (size_t g = 0; g < linear->group_count; g++) {
            const struct linear_error_group *group = &linear->groups[g];
            const float *distance_m = pick(group, &distances, mode);
            interp_shepard_again(&group->of, distance_m, norms++, interp);
            interp += group->of.count;
            if (group->papers)
                interp_paper(&group->of, (float)group->radius_m[mode], distance_m, interp);
            interp += group->papers ? group->of.count : 0;
        }
    distances_finish(&distances);
}

static bool has_value(const float *interp, size_t count)
{
    size_t i = 0;
    while (i < count && !(interp[i] > 0))
        i++;
    return i < count;
}

struct error_question {
    enum linear_error_modes modes;
    const float *const *corners, *weights;
    size_t corner_count;
    double wide_m, slack_m;
};

/* Returns the largest error of linear interpolation over all groups, as a share of the range. The error is 0 for a group
 * without a value at one of the corners, because no path leads from there to a sensor. */
static double worst_of(const struct linear_error *linear, const struct error_question *question, const float *sample)
{
    double most = 0;
    bool reached = true;
    for (size_t g = 0, first = 0; g < 4 * linear->group_count; g++) {
        const struct linear_error_group *group = &linear->groups[g / 2 % linear->group_count];
        size_t count = group->of.count;
        const float *at[3];
        if (g % 2 == INTERPOLATION_PAPER && !group->papers)
            continue;
        if (g % 2 == INTERPOLATION_SHEPARD)
            reached = has_value(sample + first, count);
        for (size_t c = 0; c < question->corner_count; c++) {
            at[c] = question->corners[c] + first;
            reached = reached && (g % 2 != INTERPOLATION_SHEPARD || has_value(at[c], count));
        }
        /* largest change of the group's value per metre at the point; a negative number means that the point has no data: minus
           its distance in metres from the area with data */
        double slope = (double)sample[linear->share_count + g];
        if (reached && slope >= -question->wide_m && question->modes & 1 << g / 2 / linear->group_count)
            most = max_of((double)interp_error(at, question->weights, question->corner_count, sample + first, count) -
                              min_of(question->slack_m * max_of(slope, 0), MAX_SLACK),
                          most); /* `most` must be the second argument: max_of() returns the second argument if the first is NaN */
        first += count;
    }
    return most;
}

double linear_error_on_edge(const struct linear_error *linear, enum linear_error_modes modes, const float *const ends[2], double t,
                            const float *between, double wide_m, double slack_m)
{
    const float weights[2] = { 1 - (float)t, (float)t };
    return worst_of(linear, &(struct error_question){ modes, ends, weights, 2, wide_m, slack_m }, between);
}

double linear_error_in_triangle(const struct linear_error *linear, enum linear_error_modes modes, const float *const corners[3],
                                const double weights[3], const float *inside, double wide_m, double slack_m)
{
    const float interp[3] = { (float)weights[0], (float)weights[1], (float)weights[2] };
    return worst_of(linear, &(struct error_question){ modes, corners, interp, 3, wide_m, slack_m }, inside);
}

double linear_error_rim_of(const struct linear_error *linear, const struct interp_norm *norms)
{
    float rim_m = INFINITY;
    for (size_t n = 0; n < 2 * linear->group_count; n++) {
        float reach_m = linear->groups[n % linear->group_count].of.reach_m;
        if (reach_m < INFINITY)
            rim_m = fminf(rim_m, fabsf(reach_m - norms[n].near_m));
    }
    return (double)rim_m;
}

/* Returns the factor by which the lengths over which the weights of a group change are shorter than with a power of 2. */
static float scale_of(const struct linear_error_group *group)
{
    return fminf(1, 2 / group->of.power);
}

double linear_error_nearest_of(const struct linear_error *linear, const struct interp_norm *norms)
{
    float nearest_m = INFINITY;
    for (size_t g = 0; g < linear->group_count; g++)
        nearest_m = fminf(nearest_m, scale_of(&linear->groups[g]) * norms[DISTANCE_EUCLIDEAN * linear->group_count + g].near_m);
    return min_of((double)nearest_m, linear_error_rim_of(linear, norms));
}

double linear_error_nearest(const struct linear_error *linear, const float point_m[3])
{
    struct corner_room room;
    size_t all = interp_padded(linear->sensor_count);
    float *straight_m = room_for(&room, all), nearest_m, scale = 1;
    interp_euclidean(point_m, (const float *const *)linear->axes_m, all, straight_m);
    for (size_t g = 0; g < linear->group_count; g++)
        scale = fminf(scale, scale_of(&linear->groups[g]));
    nearest_m = scale * interp_least(straight_m, all);
    room_finish(&room);
    return (double)nearest_m;
}

size_t linear_error_sample_count(const struct linear_error *linear)
{
    return linear->share_count + 4 * linear->group_count;
}
