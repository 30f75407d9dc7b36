/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shares of sensors, as server/field computes them, and their errors along a straight line. */
#include "preprocess/straight.h"

#include <math.h>

#include "base/mem.h"

#define LEAST_M 1e-5 /* a sensor nearer than that has all the weight */

static double factor_of(double x)
{
    return x > 0 && x < 1e4 ? x : x > 0 ? 1e4 : 0;
}

static void add_group(struct straight *straight, const struct plant *plant, int group, const struct plant_sensor *sensors)
{
    const struct plant_group *from = &plant->groups[group];
    struct straight_group *to = &straight->groups[straight->group_count];
    *to = (struct straight_group){ .power = from->power, .radius_m = { from->radius_m, from->radius_m } };
    to->columns = mem_array(straight->sensor_count, sizeof(*to->columns));
    for (uint32_t i = 0; i < straight->sensor_count; i++)
        if (plant->tags[sensors[i].tag].group == group)
            to->columns[to->count++] = i;
    for (size_t i = 0; i < to->count; i++)
        to->steepness = fmax(to->steepness, 2 * straight->strength[to->columns[i]] + fmax(1, straight->decay[to->columns[i]]));
    straight->group_count += to->count > 0;
    straight->share_count += 4 * to->count;
    if (to->count == 0)
        mem_free(to->columns);
}

void straight_init(struct straight *straight, const struct plant *plant, const struct plant_sensor *sensors, size_t sensor_count,
                   const float (*places_m)[3])
{
    *straight = (struct straight){ .sensor_count = sensor_count, .places_m = places_m };
    straight->groups = mem_array(plant->group_count, sizeof(*straight->groups));
    straight->strength = mem_array(sensor_count, sizeof(*straight->strength));
    straight->decay = mem_array(sensor_count, sizeof(*straight->decay));
    for (size_t i = 0; i < sensor_count; i++) {
        straight->strength[i] = factor_of(plant->tags[sensors[i].tag].strength);
        straight->decay[i] = factor_of(plant->tags[sensors[i].tag].decay);
    }
    for (size_t g = 0; g < plant->group_count; g++)
        add_group(straight, plant, (int)g, sensors);
}

void straight_finish(struct straight *straight)
{
    for (size_t g = 0; g < straight->group_count; g++)
        mem_free(straight->groups[g].columns);
    mem_free(straight->groups);
    mem_free(straight->strength);
    mem_free(straight->decay);
    *straight = (struct straight){ 0 };
}

void straight_set_radius(struct straight *straight, const float *const largest_m[2])
{
    for (size_t g = 0; g < straight->group_count; g++)
        for (int mode = 0; mode < 2; mode++) {
            struct straight_group *group = &straight->groups[g];
            double largest = 0;
            for (size_t i = 0; i < group->count; i++)
                largest = fmax(largest, (double)largest_m[mode][group->columns[i]]);
            if (!(group->radius_m[mode] > 0))
                group->radius_m[mode] = largest > 0 ? largest : 1;
        }
}

static double raised(double base, double power)
{
    return power == 1 ? base : power == 2 ? base * base : pow(base, power);
}

/* Returns the most that a value changes over a metre. */
static double shepard(const struct straight *straight, const struct straight_group *group, const double *distance_m, float *shares)
{
    double sum = 0, slope = 0;
    for (size_t i = 0; i < group->count; i++)
        if (isfinite(distance_m[i]))
            sum += straight->strength[group->columns[i]] / raised(fmax(distance_m[i], LEAST_M), group->power);
    for (size_t i = 0; i < group->count; i++) {
        double weight = straight->strength[group->columns[i]] / raised(fmax(distance_m[i], LEAST_M), group->power);
        shares[i] = sum > 0 && isfinite(distance_m[i]) ? (float)(weight / sum) : 0;
        slope += isfinite(distance_m[i]) ? (double)(shares[i] * (1 - shares[i])) / fmax(distance_m[i], LEAST_M) : 0;
    }
    return group->power * slope;
}

static void paper(const struct straight *straight, const struct straight_group *group, double radius_m, const double *distance_m,
                  float *shares)
{
    double sum = 0, largest = 0;
    for (size_t i = 0; i < group->count; i++)
        if (isfinite(distance_m[i]))
            largest = fmax(largest, fmax(0, 1 - distance_m[i] / radius_m) * straight->strength[group->columns[i]]);
    for (size_t i = 0; i < group->count; i++) {
        double d = isfinite(distance_m[i]) ? fmax(0, 1 - distance_m[i] / radius_m) : 0;
        double weight = isfinite(distance_m[i]) ? exp(d * straight->strength[group->columns[i]] - largest) : 0;
        sum += weight;
        shares[i] = (float)(weight * raised(d, straight->decay[group->columns[i]]));
    }
    for (size_t i = 0; i < group->count; i++)
        shares[i] = sum > 0 ? (float)((double)shares[i] / sum) : 0;
}

static double euclidean(const float a[3], const float b[3])
{
    double x = (double)a[0] - (double)b[0], y = (double)a[1] - (double)b[1], z = (double)a[2] - (double)b[2];
    return sqrt(x * x + y * y + z * z);
}

void straight_shares(const struct straight *straight, const float point_m[3], const float *geodesic_m, float *shares)
{
    float *slope = shares + straight->share_count;
    double few[64], *distance_m = straight->sensor_count <= 64 ? few : mem_array(straight->sensor_count, sizeof(*distance_m));
    for (int mode = 0; mode < 2; mode++)
        for (size_t g = 0; g < straight->group_count; g++) {
            const struct straight_group *group = &straight->groups[g];
            for (size_t i = 0; i < group->count; i++) {
                uint32_t column = group->columns[i];
                distance_m[i] = mode == DISTANCE_GEODESIC ? (double)geodesic_m[column] : euclidean(point_m, straight->places_m[column]);
            }
            *slope++ = (float)shepard(straight, group, distance_m, shares);
            paper(straight, group, group->radius_m[mode], distance_m, shares + group->count);
            *slope++ = (float)(group->steepness / group->radius_m[mode]);
            shares += 2 * group->count;
        }
    if (distance_m != few)
        mem_free(distance_m);
}

/* The largest of the errors, group by group. Where a group has no value at a corner, because no way leads there, there is no error. */
static double worst_of(const struct straight *straight, const float *const corners[3], const float weights[3], const float *sample,
                       double slack_m)
{
    const float *a = corners[0], *b = corners[1], *c = corners[2];
    double most = 0;
    bool reached = true;
    for (size_t g = 0, i = 0; g < 4 * straight->group_count; g++) {
        float above = 0, below = 0, sums[4] = { 0 };
        for (size_t end = i + straight->groups[g / 2 % straight->group_count].count; i < end; i++) {
            float difference = sample[i] - (weights[0] * a[i] + weights[1] * b[i] + weights[2] * c[i]);
            above += difference > 0 ? difference : 0;
            below -= difference < 0 ? difference : 0;
            sums[0] += sample[i];
            sums[1] += a[i];
            sums[2] += b[i];
            sums[3] += c[i];
        }
        if (g % 2 == INTERPOLATION_SHEPARD)
            reached = sums[0] > 0 && sums[1] > 0 && sums[2] > 0 && sums[3] > 0;
        if (reached)
            most = fmax(most, (double)fmaxf(above, below) - slack_m * (double)sample[straight->share_count + g]);
    }
    return most;
}

double straight_error(const struct straight *straight, const float *a, const float *b, double t, const float *between, double slack_m)
{
    return worst_of(straight, (const float *const[3]){ a, b, b }, (const float[3]){ 1 - (float)t, (float)t, 0 }, between, slack_m);
}

double straight_error_inside(const struct straight *straight, const float *const corners[3], const float *inside, double slack_m)
{
    return worst_of(straight, corners, (const float[3]){ 1 / 3.0f, 1 / 3.0f, 1 / 3.0f }, inside, slack_m);
}

double straight_nearest(const struct straight *straight, const float point_m[3])
{
    double nearest_m = INFINITY;
    for (size_t i = 0; i < straight->sensor_count; i++)
        nearest_m = fmin(nearest_m, euclidean(point_m, straight->places_m[i]));
    return nearest_m;
}

size_t straight_sample_count(const struct straight *straight)
{
    return straight->share_count + 4 * straight->group_count;
}
