/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Interpolation weights of sensors by distance, computed with vector instructions, compared with plain loops in double
   precision. */
#include "preprocess/subdivision/interp_weights.h"

#include "tests/support/test.h"

#include "tests/support/surface_case.h"

#define MOST 40
#define SAME 2e-6 /* shares are up to 1 */

struct weights_trial {
    size_t count, padded;
    float distance_m[MOST], strength[MOST], decay[MOST];
    struct interp_group group;
};

static bool takes_part(const struct weights_trial *trial, double near_m, double d)
{
    return isfinite(d) && (d < (double)trial->group.reach_m || d <= near_m);
}

/* Returns the factor by which the weight of a sensor at distance d is reduced when d approaches the reach; 1 for the nearest
   sensor, 0 beyond the reach. */
static double faded(const struct weights_trial *trial, double near_m, double d)
{
    double reach_m = (double)trial->group.reach_m;
    if (!takes_part(trial, near_m, d))
        return 0;
    return isinf(reach_m) || d <= near_m ? 1 : pow((reach_m - d) / (reach_m - near_m), 2);
}

static double least_of(const struct weights_trial *trial)
{
    double near_m = INFINITY;
    for (size_t i = 0; i < trial->count; i++)
        near_m = fmin(near_m, fmax(1e-5, (double)trial->distance_m[i]));
    return near_m;
}

/* Returns the relative change of a weight per metre of distance that is due to the factor of faded(). */
static double fading(const struct weights_trial *trial, double d)
{
    double reach_m = (double)trial->group.reach_m;
    return isinf(reach_m) ? 0 : 2 / fmax(1e-5, reach_m - d);
}

/* Fills the trial with random distances from a point to sensors. Some sensors are beyond the reach or cannot be reached, and
   some have distance zero. */
static void make(struct weights_trial *trial, bool decays)
{
    trial->count = 1 + (size_t)(cad_random(&chance) * (MOST - 8));
    trial->padded = interp_padded(trial->count);
    for (size_t i = 0; i < trial->padded; i++) {
        bool there = i < trial->count;
        double kind = cad_random(&chance);
        trial->distance_m[i] = !there || kind < 0.15 ? INFINITY : kind < 0.2 ? 0 : (float)exp(12 * cad_random(&chance) - 8);
        trial->strength[i] = there ? (float)exp(4 * cad_random(&chance) - 2) : 0;
        trial->decay[i] = there && decays ? (float)(3 * cad_random(&chance)) : 1;
    }
    trial->group = (struct interp_group){ .strength = trial->strength,
                                          .decay = trial->decay,
                                          .decays = decays,
                                          .reach_m = cad_random(&chance) < 0.5 ? INFINITY : (float)exp(6 * cad_random(&chance) - 3),
                                          .count = trial->padded };
}

TEST(shepards_shares_are_those_of_a_plain_loop)
{
    const float powers[5] = { 1, 2, 3, 2.5f, 12 };
    for (int n = 0; n < 2000; n++) {
        struct weights_trial trial;
        float shares[MOST];
        double weights[MOST], sum = 0, slope = 0, fade = 0, fastest = 0;
        make(&trial, false);
        trial.group.power = powers[n % 5];
        double near_m = least_of(&trial);
        for (size_t i = 0; i < trial.count; i++) {
            double d = fmax(1e-5, (double)trial.distance_m[i]);
            weights[i] = isfinite(d) ? (double)trial.strength[i] * pow(near_m / d, (double)trial.group.power) : 0;
            weights[i] *= faded(&trial, near_m, d);
            sum += weights[i];
        }
        struct interp_norm norm, alone;
        float again[MOST], found = interp_shepard(&trial.group, trial.distance_m, true, shares, &norm);
        interp_shepard_norm(&trial.group, trial.distance_m, &alone);
        interp_shepard_again(&trial.group, trial.distance_m, &alone, again);
        assert_memory_equal(&norm, &alone, sizeof(norm));
        assert_memory_equal(again, shares, trial.padded * sizeof(*shares));
        assert_float_equal((double)norm.near_m, near_m, 1e-6 * near_m);
        for (size_t i = 0; i < trial.padded; i++) {
            double share = i < trial.count && sum > 0 ? weights[i] / sum : 0;
            assert_float_equal(shares[i], share, SAME);
            if (i < trial.count && isfinite(trial.distance_m[i]))
                slope += share * (1 - share) / fmax(1e-5, (double)trial.distance_m[i]);
            if (i >= trial.count || !(share > 0))
                continue;
            fade += share * (1 - share) * fading(&trial, fmax(1e-5, (double)trial.distance_m[i]));
            fastest = fmax(fastest, fading(&trial, fmax(1e-5, (double)trial.distance_m[i])));
        }
        slope = slope * (double)trial.group.power + fade;
        assert_true(fabs((double)found - slope) <=
                    1e-4 * slope + 2e-6 * (double)trial.group.power * MOST / fmin(near_m, 1) + 1e-3 * fade + 2e-6 * MOST * fastest);
    }
}

TEST(papers_shares_are_those_of_a_plain_loop)
{
    for (int n = 0; n < 2000; n++) {
        struct weights_trial trial;
        float shares[MOST], radius_m = (float)exp(4 * cad_random(&chance) - 1);
        double weights[MOST], near[MOST], sum = 0, all = 0, slope = 0;
        make(&trial, n % 2);
        double near_m = least_of(&trial);
        for (size_t i = 0; i < trial.count; i++) {
            near[i] = fmax(0, 1 - (double)trial.distance_m[i] / (double)radius_m);
            weights[i] = isfinite(trial.distance_m[i]) ? exp(near[i] * (double)trial.strength[i]) : 0;
            weights[i] *= faded(&trial, near_m, (double)trial.distance_m[i]);
            sum += weights[i];
        }
        float found = interp_paper(&trial.group, radius_m, trial.distance_m, shares);
        for (size_t i = 0; i < trial.padded; i++) {
            double share = i < trial.count && sum > 0 ? weights[i] / sum * pow(near[i], (double)trial.decay[i]) : 0;
            assert_float_equal(shares[i], share, SAME);
            all += share;
        }
        for (size_t i = 0; i < trial.count; i++) {
            double weight = sum > 0 ? weights[i] / sum : 0, share = (double)shares[i], s = (double)trial.strength[i];
            s += fading(&trial, (double)trial.distance_m[i]) * (double)radius_m;
            if (near[i] > 0 || (isfinite(trial.group.reach_m) && weight > 0))
                slope += fmax(s * share * (1 - weight) + (double)trial.decay[i] * share / fmax(near[i], 1e-3), s * weight * (all - share));
        }
        slope /= (double)radius_m;
        assert_float_equal(found, slope, 1e-3 * slope + 1e-4 / (double)radius_m);
    }
}

/* interp_paper() returns a bound on how fast the value changes with the distances to the sensors. For random distances and any
   readings the bound must hold, as long as no sensor crosses its radius. */
TEST(no_value_changes_faster_than_is_said)
{
    for (int n = 0; n < 2000; n++) {
        struct weights_trial trial;
        float shares[2][MOST], radius_m = (float)exp(4 * cad_random(&chance) - 1), step_m = 1e-3f * radius_m;
        double more = 0, less = 0;
        make(&trial, n % 2);
        if (isfinite(trial.group.reach_m))
            trial.group.reach_m = radius_m * (float)(0.5 + 2 * cad_random(&chance));
        const float reach_m = trial.group.reach_m;
        for (size_t i = 0; i < trial.count; i++) {
            if (trial.distance_m[i] < radius_m)
                trial.distance_m[i] = fminf(fmaxf(trial.distance_m[i], step_m), 0.95f * radius_m);
            /* moves sensors out of the fifth below and above the reach, because there the weight changes slowly at first and
               then faster */
            if (fabsf(trial.distance_m[i] - reach_m) < 0.2f * reach_m)
                trial.distance_m[i] = i % 2 ? 0.8f * reach_m : 1.2f * reach_m;
        }
        /* skips cases without a sensor within reach, in which the nearest sensor alone determines the value */
        if (least_of(&trial) > (double)reach_m)
            continue;
        float said = interp_paper(&trial.group, radius_m, trial.distance_m, shares[0]);
        for (size_t i = 0; i < trial.count; i++)
            if (trial.distance_m[i] < radius_m)
                trial.distance_m[i] += (float)(2 * cad_random(&chance) - 1) * step_m;
        interp_paper(&trial.group, radius_m, trial.distance_m, shares[1]);
        for (size_t i = 0; i < trial.count; i++) {
            double change = (double)shares[1][i] - (double)shares[0][i];
            more += fmax(change, 0);
            less -= fmin(change, 0);
        }
        assert_true(fmax(more, less) <= 1.05 * (double)said * (double)step_m + 2e-5);
    }
}

TEST(distances_and_errors_are_those_of_a_plain_loop)
{
    for (int n = 0; n < 500; n++) {
        float values[7][MOST], distance_m[MOST], point[3], weights[3];
        const size_t count = 8 * (1 + (size_t)(cad_random(&chance) * 5));
        double above = 0, below = 0, least = INFINITY;
        size_t corners = 2 + (size_t)(n % 2);
        for (int a = 0; a < 7; a++)
            for (size_t i = 0; i < count; i++)
                values[a][i] = (float)cad_random(&chance);
        for (int i = 0; i < 3; i++) {
            point[i] = (float)cad_random(&chance);
            weights[i] = (float)cad_random(&chance);
        }
        interp_euclidean(point, (const float *const[3]){ values[0], values[1], values[2] }, count, distance_m);
        float error = interp_error((const float *const[3]){ values[3], values[4], values[5] }, weights, corners, values[6], count);
        for (size_t i = 0; i < count; i++) {
            double d[3], more = (double)values[6][i];
            for (int a = 0; a < 3; a++) {
                d[a] = (double)values[a][i] - (double)point[a];
                more -= (size_t)a < corners ? (double)weights[a] * (double)values[3 + a][i] : 0;
            }
            assert_float_equal(distance_m[i], sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), 1e-6);
            least = fmin(least, (double)distance_m[i]);
            above += fmax(more, 0);
            below += fmax(-more, 0);
        }
        assert_float_equal(interp_least(distance_m, count), least, 0);
        assert_float_equal(error, fmax(above, below), 1e-5);
    }
}

TEST_GROUP(surface_case_set_up, surface_case_tear_down)
