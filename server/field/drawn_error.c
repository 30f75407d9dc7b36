/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures the error of linear interpolation within triangles by comparing it with the field at sample points. Samples only
   triangles in which the weights may be noticeably nonlinear, more densely near sensors. */
#include "field/drawn_error.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "field/ridges.h"
#include "field/update.h"
#include "plant/exact.h"
#include "plant/influence.h"
#include "plant/singles.h"

/* GROUP: number of triangles evaluated together. GRAIN: number of triangles per job of a worker thread. MAX_PIECES: maximum
   number of pieces into which one triangle is split by repeated halving. */
enum { GROUP = 64, GRAIN = 1024, MAX_PIECES = 96 };
/* MOST_SAMPLES: expected number of samples in one level of detail, multiplied by the number of sensors, up to which all triangles
   are sampled. They take two cores about 0.15 s; all those of a part of 50,000 long triangles with 512 sensors would take 10 s. */
enum { MOST_SAMPLES = 10000000 };
/* largest length of a piece (part of a triangle), relative to its distance to the nearest sensor; longer pieces are halved */
#define STEP 0.3f
/* exponent of the distance in the interpolation shepard (inverse distance weighting) up to which pieces of the length STEP are
   short enough to find the error; with a larger exponent, pieces are shorter in proportion */
#define MAX_POWER 2.0f
/* divisor in the bound of the interpolation error of shepard in a triangle, which is L^2 K / (6 d^2). L is the triangle's
   longest side, d its distance to the nearest sensor, and K / d^2 a bound on the second derivative of the weights */
#define SHEPARD_ACCEPTED 6.0f
/* added to K if weights fall to zero at a limited reach; d is then at most the distance to the end of the nearest sensor's reach. Each
   sensor at the end of its reach adds at most REACH_BEND_EACH. In 720,000 random triangles with 2 to 40 sensors, many at the end of
   their reach, and powers of 0.25 to 4, this addition was at most REACH_BEND. */
#define REACH_BEND 12.0f
#define REACH_BEND_EACH 2.0f
/* for interpolation paper (Algorithm 1 of Kim & Suh): longest side of a triangle that needs no samples, as a fraction of the
   distance to the nearest sensor and of the radius R */
#define PAPER_ACCEPTED 0.015f
/* largest accepted error of SHOW_BLIND, as a fraction of the colour scale. It grows so fast with distance that linear
   interpolation is a colour step off on most triangles. */
#define BLIND_ACCEPTED 0.1f
/* A drawn frame may show data where the field has none, up to this far beyond the border of the data; a larger overlap counts
   as an error. Unit: steps of the byte scalar.lacking (encoded distance from that border) */
#define BORDER_SLACK 4
/* if interpolation errors affect at least this fraction of the area of a level of detail, an error is stored for all vertices
   of the level, even for those without an error of their own */
#define MARK_ALL 0.75
#define MIN_ERROR 1e-4f /* interpolation errors smaller than this are stored as 0 */

struct triangle_piece {  /* part of a triangle; the error is sampled at the midpoint of the piece's longest side */
    uint32_t tri;        /* index of the triangle in its group of triangles evaluated together */
    float corners[3][3]; /* barycentric coordinates of the piece's corners */
};

struct sampler { /* working memory of one thread that samples triangles */
    const struct weights *of;
    const struct drawn_near *near; /* see struct drawn_error_job */
    bool has_values;               /* see struct drawn_error_job */
    const struct asset_view *file;
    struct field_layout layout;
    struct layout_points points;
    struct weights *weights; /* weights at the sample points */
    struct weights_terms terms;
    double values[KERNEL_BLOCK], total[KERNEL_BLOCK];
    /* weights at the triangles' corners: [sensor, or other term of the sum][3 corners of each of GROUP triangles] */
    float *corners;
    uint32_t *tris[GROUP]; /* vertex numbers of each triangle */
    float *errors[GROUP];  /* pointer for each triangle of the group to the element that receives its measured error */
    int pieces[GROUP];
    size_t tri_count;
    struct triangle_piece *queue;
    size_t queued, capacity;
};

struct drawn_error_job {
    struct weights *weights;
    const struct field_params *params;
    const uint8_t *usable, *members_marked;
    float radius_m, accepted, error_m;
    const uint32_t *members;
    const double *ones;
    uint32_t first;       /* index of the first triangle whose interpolation error to measure */
    /* [n]: number of the level's triangles that need about n samples (samples_of()) */
    atomic_size_t needing[MAX_PIECES + 1];
    bool has_border; /* somewhere there is no data (has_border()) */
    /* samples only triangles at the border of the reach, because preparation left no error of values in the others. Preparation does
       not cut triangles in which only one sensor has weight, so a large one may show the border elsewhere */
    bool at_border_only;
    /* false: the weights are not measured, only `near`, or the border of prepared weights' data: prepared weights are linear within
       triangles by definition */
    bool has_values;
    int most_pieces;      /* triangles that need more samples than this get a bound instead; MAX_PIECES: all are sampled */
    float *errors;        /* interpolation error of each triangle */
    float *ridges;        /* error of values in each triangle where paths from two sides meet; NULL: not measured */
    float *vertex_errors; /* error of each vertex's value due to errors of geodesic distances; NULL: not measured */
    /* a value that depends on the distance to the nearest sensor alone, which is measured instead of the weights; NULL: the weights
       are measured */
    const struct drawn_near *near;
};

/* --- weights at points ------------------------------------------------------------------------------------------------------ */

static bool sampler_init(struct sampler *sampler, const struct drawn_error_job *job)
{
    size_t members = job->weights->member_count;
    *sampler = (struct sampler){
        .of = job->weights, .near = job->near, .file = &job->weights->layout->file->view, .layout = *job->weights->layout
    };
    sampler->layout.points = &sampler->points;
    sampler->layout.vertex_count = KERNEL_BLOCK;
    sampler->points.positions_m = mem_array(KERNEL_BLOCK, sizeof(*sampler->points.positions_m));
    sampler->points.corners = mem_array(KERNEL_BLOCK, sizeof(*sampler->points.corners));
    sampler->points.parts = mem_array(KERNEL_BLOCK, sizeof(*sampler->points.parts));
    sampler->points.away_m = mem_array(KERNEL_BLOCK, sizeof(*sampler->points.away_m));
    sampler->has_values = job->has_values;
    sampler->weights = job->has_values
                           ? weights_create(&sampler->layout, job->params, job->radius_m, job->usable, &(struct weights_key){ 0 })
                           : weights_create_border(&sampler->layout, job->params, job->usable);
    sampler->terms = (struct weights_terms){ job->members, job->ones, job->members_marked, members };
    if (!sampler->has_values)
        return sampler->weights;
    sampler->corners = mem_try_array(members * 3 * GROUP, sizeof(float));
    return sampler->corners && sampler->weights && weights_keep(sampler->weights, weights_column_bytes(sampler->weights)) > 0;
}

static void sampler_finish(struct sampler *sampler)
{
    weights_destroy(&sampler->weights);
    mem_free(sampler->points.positions_m);
    mem_free(sampler->points.corners);
    mem_free(sampler->points.parts);
    mem_free(sampler->points.away_m);
    mem_free(sampler->corners);
    mem_free(sampler->queue);
}

/* Evaluates the weights of all sensors at the group's sample points. A sensor's final weight at a point is its element in
   sampler->weights divided by the point's element in `total`. */
static void evaluate(struct sampler *sampler, size_t count)
{
    struct weights *weights = sampler->weights;
    weights->known[0] = sampler->has_values ? 0 : KNOWN_TOP; /* only weights need `top` */
    weights_prepare(weights, 0, count);
    if (!sampler->has_values)
        return;
    memset(weights->kept, 0, weights->member_count);
    memset(sampler->values, 0, count * sizeof(*sampler->values));
    memset(sampler->total, 0, count * sizeof(*sampler->total));
    weights_add(weights, 0, count, &sampler->terms, &(struct weights_sums){ sampler->values, sampler->total, NULL });
    for (size_t j = 0; j < count; j++)
        sampler->total[j] = sampler->total[j] > 0 ? 1 / sampler->total[j] : 0;
}

/* --- measuring the errors of one group of triangles ------------------------------------------------------------------------- */

static void evaluate_corners(struct sampler *sampler)
{
    static const float at_corner[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
    size_t count = 3 * sampler->tri_count;
    if (!sampler->has_values)
        return;
    for (size_t j = 0; j < count; j++)
        layout_set_point(sampler->file, &sampler->points, j, sampler->tris[j / 3], at_corner[j % 3]);
    evaluate(sampler, count);
    for (uint32_t m = 0; m < sampler->weights->member_count; m++) {
        const float *column = weights_column(sampler->weights, 0, m);
        for (size_t j = 0; j < count; j++)
            sampler->corners[m * 3 * GROUP + j] = column[j] * (float)sampler->total[j];
    }
}

static void enqueue(struct sampler *sampler, const struct triangle_piece *piece)
{
    if (sampler->pieces[piece->tri]++ >= MAX_PIECES) {
        if (sampler->near && sampler->near->group) /* no sample may see a hot spot in the rest of the triangle */
            *sampler->errors[piece->tri] = 1;
        return;
    }
    mem_grow(&sampler->queue, &sampler->capacity, sampler->queued + 1, sizeof(*sampler->queue));
    sampler->queue[sampler->queued++] = *piece;
}

/* Returns the length of the piece's longest side. *begin receives the index of the corner at which that side begins. */
static float longest_side(const struct sampler *sampler, const struct triangle_piece *piece, int *begin)
{
    float at[3][3], longest = -1;
    const uint32_t *corners = sampler->tris[piece->tri];
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++) {
            at[k][c] = 0;
            for (int i = 0; i < 3; i++)
                at[k][c] += piece->corners[k][i] * sampler->file->positions_m[corners[i]][c];
        }
    for (int k = 0; k < 3; k++) {
        float length = vecf_distance(at[k], at[(k + 1) % 3]);
        if (length > longest) {
            longest = length;
            *begin = k;
        }
    }
    return longest;
}

static void split(struct sampler *sampler, const struct triangle_piece *piece, int begin, const float middle[3])
{
    struct triangle_piece half = *piece;
    memcpy(half.corners[begin], middle, sizeof(half.corners[begin]));
    enqueue(sampler, &half);
    half = *piece;
    memcpy(half.corners[(begin + 1) % 3], middle, sizeof(half.corners[begin]));
    enqueue(sampler, &half);
}

/* Returns true if a frame would show data at this point, interpolated from the triangle's corners, although the field has none there. */
static bool hides_rim(const struct sampler *sampler, size_t point, const struct triangle_piece *piece, const float parts[3], bool *shown)
{
    const uint32_t *corners = sampler->tris[piece->tri];
    float drawn = 0, here = weights_lacking_at(sampler->weights, point, false);
    for (int k = 0; k < 3; k++)
        drawn += parts[k] * (float)weights_lacking_at(sampler->of, corners[k], false);
    *shown = here <= 127;
    return here > 127 + BORDER_SLACK && drawn <= 127;
}

static void add_errors(struct sampler *sampler, const struct triangle_piece *pieces, size_t count)
{
    float more[KERNEL_BLOCK] = { 0 }, less[KERNEL_BLOCK] = { 0 };
    for (uint32_t m = 0; sampler->has_values && m < sampler->weights->member_count; m++) {
        const float *column = weights_column(sampler->weights, 0, m), *at = sampler->corners + m * 3 * GROUP;
        for (size_t j = 0; j < count; j++) {
            const float *corner = at + 3 * pieces[j].tri, *part = sampler->points.parts[j];
            float off = column[j] * (float)sampler->total[j] - part[0] * corner[0] - part[1] * corner[1] - part[2] * corner[2];
            more[j] += off > 0 ? off : 0;
            less[j] -= off < 0 ? off : 0;
        }
    }
    for (size_t j = 0; j < count; j++) {
        bool shown;
        float *error = sampler->errors[pieces[j].tri], worst = fmaxf(more[j], less[j]);
        if (hides_rim(sampler, j, &pieces[j], sampler->points.parts[j], &shown))
            *error = WEIGHTS_SHOWS_NO_DATA;
        else if (shown && worst > MIN_ERROR)
            *error = fmaxf(*error, worst);
    }
}

/* --- values that depend on the distance to the nearest sensor alone ------------------------------------------------------- */

static float shown_at(const struct drawn_near *near, float near_m)
{
    return near->group ? update_blind(near->group, near_m) : near_m;
}

/* Returns the place of a value on the colour scale, 0 to 1. The scale of SHOW_BLIND is logarithmic and ends at the group's range. */
static float scale_of(const struct drawn_near *near, float shown)
{
    if (!near->group)
        return shown / near->largest_m;
    const float most = (float)(near->group->max - near->group->min), least = (float)PLANT_SEEN_PART * most;
    return logf(fminf(fmaxf(shown, least), most) / least) / logf(most / least);
}

/* Returns the largest accepted error, as a fraction of the colour scale. */
static float accepted_near(const struct drawn_near *near)
{
    return near->group ? BLIND_ACCEPTED : STEP_OF_COLOR;
}

static void add_near_errors(struct sampler *sampler, const struct triangle_piece *pieces, size_t count)
{
    for (size_t j = 0; j < count; j++) {
        const uint32_t *corners = sampler->tris[pieces[j].tri];
        float drawn = 0, *error = sampler->errors[pieces[j].tri];
        for (int k = 0; k < 3; k++)
            drawn += sampler->points.parts[j][k] * shown_at(sampler->near, sampler->of->near_m[corners[k]]);
        float here = scale_of(sampler->near, shown_at(sampler->near, sampler->weights->near_m[j]));
        *error = fmaxf(*error, fabsf(scale_of(sampler->near, drawn) - here));
    }
}

/* Returns true if a triangle needs no samples: a corner has no distance, or its longest side is so short that interpolation is off
   by at most the accepted error (SHOW_BLIND: twice that). Because a distance changes by at most the length of the way, a distance
   interpolated within the triangle is off by at most the mean of the lengths to the corners, weighted by the barycentric
   coordinates. This is at most 1 / sqrt(3) of the longest side. */
static bool is_even(const struct drawn_near *near, float longest_m, float nearest_m, float farthest_m)
{
    float off_m = 0.58f * longest_m, low = scale_of(near, shown_at(near, fmaxf(nearest_m - off_m, 0)));
    return !isfinite(farthest_m) || scale_of(near, shown_at(near, farthest_m + off_m)) - low <= 2 * accepted_near(near);
}

/* Returns whether a piece is halved. near_m: distance from its middle to the nearest sensor. */
static bool is_long(const struct sampler *sampler, float step, float length_m, float near_m)
{
    const struct drawn_near *near = sampler->near;
    if (!near)
        return length_m > step * near_m;
    if (!near->group)
        return length_m > step * near_m && length_m > STEP_OF_COLOR * near->largest_m;
    /* beyond `seen_m`, all values have the colour above the scale */
    const float spot_m = (float)near->group->hot_spot_m, seen_m = spot_m * sqrtf(2 * logf(1 / (float)PLANT_SEEN_PART));
    return length_m > STEP * spot_m && near_m - length_m < seen_m;
}

static void sample_group(struct sampler *sampler, float step)
{
    struct triangle_piece taken[KERNEL_BLOCK];
    int begins[KERNEL_BLOCK];
    float lengths_m[KERNEL_BLOCK];
    evaluate_corners(sampler);
    for (uint32_t t = 0; t < sampler->tri_count; t++) {
        sampler->pieces[t] = 0;
        enqueue(sampler, &(struct triangle_piece){ t, { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } });
    }
    for (size_t next = 0; next < sampler->queued;) {
        size_t count = sampler->queued - next < KERNEL_BLOCK ? sampler->queued - next : KERNEL_BLOCK;
        memcpy(taken, sampler->queue + next, count * sizeof(*taken));
        next += count;
        for (size_t j = 0; j < count; j++) {
            float middle[3];
            lengths_m[j] = longest_side(sampler, &taken[j], &begins[j]);
            for (int i = 0; i < 3; i++)
                middle[i] = 0.5f * (taken[j].corners[begins[j]][i] + taken[j].corners[(begins[j] + 1) % 3][i]);
            layout_set_point(sampler->file, &sampler->points, j, sampler->tris[taken[j].tri], middle);
        }
        evaluate(sampler, count);
        if (sampler->near)
            add_near_errors(sampler, taken, count);
        else
            add_errors(sampler, taken, count);
        for (size_t j = 0; j < count; j++)
            if (is_long(sampler, step, lengths_m[j], sampler->weights->near_m[j]))
                split(sampler, &taken[j], begins[j], sampler->points.parts[j]);
    }
    sampler->queued = sampler->tri_count = 0;
}

/* --- errors of distances ---------------------------------------------------------------------------------------------------- */

/* Returns true if errors of geodesic distances change the field's values noticeably, as they do with a high power. */
static bool amplifies_distances(const struct weights *weights)
{
    return weights->distance != DISTANCE_EUCLIDEAN && weights->interpolation == INTERPOLATION_SHEPARD && weights->power >= PLANT_HIGH_POWER;
}

/* Returns a bound on the error of values due to errors of distances: a value v, which is the weighted mean of readings, changes
   by at most the result times the weighted mean of |reading - v|. 0: the errors are negligible. Reason: errors of distances
   multiply each weight by some factor between `least` and `most`, whose difference from their mean is at most (most - least) /
   2, and the sum of weights by at least `least`. */
double drawn_error_of_distances(const struct weights *weights)
{
    if (!amplifies_distances(weights))
        return 0;
    double power = (double)weights->power, most = pow(1 + PLANT_DISTANCE_ERROR, power), least = pow(1 - PLANT_DISTANCE_ERROR, power);
    return (most - least) / (2 * least);
}

/* Writes each vertex's error due to errors of distances, for the worst possible readings, for the blocks of vertices
   begin..end-1. If one sensor has the fraction `a` of the weights, the mean deviation of the readings is at most 2 a (1 - a)
   times their spread. The worst `a` is the nearest sensor's if that is at least 1/2, else 1/2. Errors below half a colour step
   are ignored: added to interpolation errors just below a step, they would mark most of the surface. */
static void amplify_some(void *arg, size_t begin, size_t end)
{
    const struct drawn_error_job *job = arg;
    const double e = drawn_error_of_distances(job->weights);
    const struct weights_terms terms = { job->members, job->ones, job->members_marked, job->weights->member_count };
    for (size_t block = begin; block < end; block++) {
        double values[KERNEL_BLOCK] = { 0 }, total[KERNEL_BLOCK] = { 0 };
        size_t at = block * KERNEL_BLOCK, left = job->weights->layout->vertex_count - at, count = left < KERNEL_BLOCK ? left : KERNEL_BLOCK;
        weights_add(job->weights, at, count, &terms, &(struct weights_sums){ values, total, NULL });
        /* the nearest sensor's share of the weights is 1 / total, because weights are relative to the nearest sensor's, which
           is 1 (kernels.h) */
        for (size_t j = 0; j < count; j++) {
            double share = total[j] > 0 ? fmax(1 / total[j], 0.5) : 1;
            double error = 2 * e * share * (1 - share);
            job->vertex_errors[at + j] = error > 0.5 * (double)STEP_OF_COLOR ? (float)error : 0;
        }
    }
}

/* --- measuring the errors of an asset's triangles --------------------------------------------------------------------------- */

/* Returns the largest length of a piece, relative to its distance to the nearest sensor. */
static float step_of(const struct drawn_error_job *job)
{
    return job->has_values ? STEP * fminf(1, MAX_POWER / job->weights->power) : STEP;
}

struct triangle_extent {            /* size of a triangle and its distance from sensors and from the border of the reach */
    float longest_m, near_m, far_m; /* longest side; distances of the nearest and the farthest corner */
    bool data;                      /* a corner has data */
};

static struct triangle_extent extent_of(const struct drawn_error_job *job, const uint32_t corners[3])
{
    const struct weights *weights = job->weights;
    const float(*at)[3] = weights->layout->file->view.positions_m;
    struct triangle_extent extent = { .near_m = INFINITY };
    for (int k = 0; k < 3; k++) {
        extent.longest_m = fmaxf(extent.longest_m, vecf_distance(at[corners[k]], at[corners[(k + 1) % 3]]));
        extent.near_m = fminf(extent.near_m, weights->near_m[corners[k]]);
        extent.far_m = fmaxf(extent.far_m, weights->near_m[corners[k]]);
        extent.data |= weights->place[corners[k]] != PLACE_NOBODY;
        if (weights->reach_m < INFINITY && !job->near)
            extent.near_m = fminf(extent.near_m, fabsf(weights->reach_m - weights->near_m[corners[k]]));
    }
    return extent;
}

/* Returns whether a frame might show data inside the triangle where the field has none. The distance beyond the border of the data
   changes by at most two metres per metre, but not steadily at the border of the surroundings of a sensor without limits. */
static bool may_hide_rim(const struct drawn_error_job *job, const uint32_t corners[3], float longest_m)
{
    const struct weights *weights = job->weights;
    float least = 255, most = 0;
    for (int k = 0; k < 3; k++) {
        if (weights->place[corners[k]] == PLACE_NO_LIMITS)
            return true;
        float lacking = weights_lacking_at(weights, corners[k], false);
        least = fminf(least, lacking);
        most = fmaxf(most, lacking);
    }
    return job->has_border && least <= 127 && most + 2 * longest_m * weights->steps_per_m > 127 + BORDER_SLACK;
}

/* Returns about how many samples a triangle needs; 0: none, because it is small compared with the distance to the nearest sensor
   or, in a coarse level, smaller than the pixels with which the level is drawn. */
static int samples_of(const struct drawn_error_job *job, const uint32_t corners[3], const struct triangle_extent *extent)
{
    const float longest_m = extent->longest_m;
    if (job->at_border_only && !may_hide_rim(job, corners, longest_m))
        return 0;
    if (longest_m < 2 * job->error_m || (job->near ? is_even(job->near, longest_m, extent->near_m, extent->far_m) : !extent->data))
        return 0;
    if (!job->near && longest_m <= job->accepted * (extent->near_m - longest_m))
        return 0;
    float pieces = longest_m / fmaxf(step_of(job) * extent->near_m, 0.1f * longest_m);
    return 1 + (int)fminf(pieces * pieces, MAX_PIECES - 1);
}

static void count_samples(void *arg, size_t begin, size_t end)
{
    struct drawn_error_job *job = arg;
    const uint32_t *indices = job->weights->layout->file->view.indices;
    size_t needing[MAX_PIECES + 1] = { 0 };
    for (size_t t = job->first + begin; t < job->first + end; t++) {
        struct triangle_extent extent = extent_of(job, indices + 3 * t);
        needing[samples_of(job, indices + 3 * t, &extent)]++;
    }
    for (int n = 0; n <= MAX_PIECES; n++)
        atomic_fetch_add_explicit(&job->needing[n], needing[n], memory_order_relaxed);
}

/* Chooses the triangles to sample, so that the level takes at most MOST_SAMPLES: those that need few samples. The others are large
   compared with their distance to the nearest sensor, or to the border of the reach. A distance alone (job->near) costs little. */
static void choose_sampled(struct drawn_error_job *job)
{
    const size_t sensors = job->weights->layout->sensor_count + (job->has_values ? 2 * job->weights->member_count : 0);
    size_t samples = 0;
    for (job->most_pieces = job->near ? MAX_PIECES : 0; job->most_pieces < MAX_PIECES; job->most_pieces++) {
        samples += (size_t)(job->most_pieces + 1) * job->needing[job->most_pieces + 1];
        if (samples > MOST_SAMPLES / (sensors > 0 ? sensors : 1))
            return;
    }
}

/* Returns a bound on the interpolation error inside a triangle (SHEPARD_ACCEPTED); 1: none is known. */
static float bound_of(const struct drawn_error_job *job, const uint32_t corners[3], const struct triangle_extent *extent)
{
    const float away_m = extent->near_m - extent->longest_m;
    if (!job->near && may_hide_rim(job, corners, extent->longest_m))
        return WEIGHTS_SHOWS_NO_DATA;
    if (job->near || job->weights->interpolation != INTERPOLATION_SHEPARD || !(away_m > 0))
        return 1;
    const float ratio = extent->longest_m / (job->accepted * away_m);
    return fminf(1, STEP_OF_COLOR * ratio * ratio);
}

static void measure_some(void *arg, size_t begin, size_t end)
{
    const struct drawn_error_job *job = arg;
    struct sampler *sampler = NULL;
    uint32_t *indices = (uint32_t *)job->weights->layout->file->view.indices;
    bool good = true;
    for (size_t t = job->first + begin; t < job->first + end; t++) {
        uint32_t *corners = indices + 3 * t;
        struct triangle_extent extent = extent_of(job, corners);
        int samples = samples_of(job, corners, &extent);
        bool sampled = samples > 0 && samples <= job->most_pieces;
        if (sampled && !sampler) {
            sampler = mem_new(sizeof(*sampler));
            good = sampler_init(sampler, job);
        }
        if (sampled && good) {
            sampler->tris[sampler->tri_count] = corners;
            sampler->errors[sampler->tri_count++] = &job->errors[t];
        } else if (samples > 0) { /* sampling would take too long, or memory is missing */
            job->errors[t] = bound_of(job, corners, &extent);
        }
        if (sampler && (sampler->tri_count == GROUP || (sampler->tri_count > 0 && t + 1 == job->first + end)))
            sample_group(sampler, step_of(job));
    }
    if (sampler)
        sampler_finish(sampler);
    mem_free(sampler);
}

static void prepare_some(void *arg, size_t begin, size_t end)
{
    struct weights *weights = arg;
    for (size_t block = begin; block < end; block++) {
        size_t at = block * KERNEL_BLOCK, left = weights->layout->vertex_count - at;
        weights_prepare(weights, at, left < KERNEL_BLOCK ? left : KERNEL_BLOCK);
    }
}

/* Returns the largest size of triangles that need no samples, as a fraction of the distance d to the nearest sensor; 0: all
   need samples. Shepard's weights have a second derivative of at most K / d^2, which follows from that of D^-p, with p the
   power, D the distance and |grad D| = 1. With a limited reach, that of (1 - D / reach)^2 adds to it. */
static float accepted_of(const struct weights *weights)
{
    const float p = weights->power;
    const float bend = weights->reach_m < INFINITY ? fmaxf(REACH_BEND, REACH_BEND_EACH * (float)weights->member_count) : 0;
    if (weights->interpolation == INTERPOLATION_SHEPARD)
        return sqrtf(SHEPARD_ACCEPTED * STEP_OF_COLOR / (1.5f * p * p + 0.5f * p + bend));
    for (size_t m = 0; m < weights->member_count; m++)
        if (weights->decay[weights->members[m]] != 1 || weights->strength[weights->members[m]] > 1)
            return 0;
    return PAPER_ACCEPTED;
}

/* Writes to erring[b] the fraction of the level's area on which the error of values is at least 2^-b (1, 1/2, 1/4 and so on).
   Returns the largest error. */
static float find_erring(const struct asset_view *file, const struct asset_level *level, const float *errors, float erring[WEIGHTS_ERRING])
{
    double areas[WEIGHTS_ERRING] = { 0 }, all = 0;
    float largest = 0;
    for (uint32_t p = level->first_primitive; p < level->first_primitive + level->primitive_count; p++) {
        const struct asset_primitive *primitive = &file->primitives[p];
        for (uint32_t i = primitive->first_index; i < primitive->first_index + primitive->index_count; i += 3) {
            const float(*at)[3] = file->positions_m;
            double normal[3];
            vecf_normal(at[file->indices[i]], at[file->indices[i + 1]], at[file->indices[i + 2]], normal);
            double area = vec_length(normal);
            all += area;
            largest = fmaxf(largest, fminf(errors[i / 3], 1));
            for (int b = 0; b < WEIGHTS_ERRING; b++)
                areas[b] += errors[i / 3] >= ldexpf(1, -b) ? area : 0;
        }
    }
    for (int b = 0; b < WEIGHTS_ERRING; b++)
        erring[b] = all > 0 ? (float)(areas[b] / all) : 0;
    return largest;
}

/* Returns the error with which all vertices of a level are marked, because too large a part of the level has interpolation
   errors; 0: the part is small enough. All vertices are marked, because distances along the surface are measured on the same
   triangles. If most triangles are too long for the field, these distances are wrong too, even at triangles without
   interpolation errors (tests/bench/notes/windows.md). Thresholds 1, 1/2, 1/4, ... are tried in this order. If at least the
   fraction MARK_ALL of the level's area has errors of a threshold or more, the result is twice that threshold, but at most the
   level's largest error. */
static float error_of_all(const struct weights *weights, const float erring[WEIGHTS_ERRING], float largest)
{
    for (int b = 0; b < WEIGHTS_ERRING && weights->distance != DISTANCE_EUCLIDEAN; b++)
        if ((double)erring[b] >= MARK_ALL)
            return fminf(ldexpf(1, 1 - b), largest);
    return 0;
}

/* Raises each vertex's error to the largest error of the adjacent triangles, and at least to `least`. */
static void raise_vertices(const struct asset_view *file, const struct asset_level *level, const float *errors, float least,
                           float *of_vertex)
{
    for (uint32_t p = level->first_primitive; p < level->first_primitive + level->primitive_count; p++) {
        const struct asset_primitive *primitive = &file->primitives[p];
        for (uint32_t i = primitive->first_index; i < primitive->first_index + primitive->index_count; i++) {
            float *error = &of_vertex[file->indices[i]];
            *error = fmaxf(*error, fmaxf(least, errors[i / 3]));
        }
    }
}

/* Merges the errors of a level's triangles into those of its vertices, and adds the errors at ridges, and those at vertices that
   inaccurate distances cause. */
static void spread(struct weights *weights, const struct drawn_error_job *job, const struct asset_level *level)
{
    float *errors = job->errors;
    const float *ridges = job->ridges, *at_vertices = job->vertex_errors;
    const struct asset_view *file = &weights->layout->file->view;
    float erring[WEIGHTS_ERRING], largest = find_erring(file, level, errors, erring), least = error_of_all(weights, erring, largest);
    if (ridges) {
        for (uint32_t t = 0; t < file->header->index_count / 3; t++)
            errors[t] += ridges[t];
        largest = find_erring(file, level, errors, erring);
    }
    if (at_vertices) {
        if (weights->interpolation_errors)
            raise_vertices(file, level, errors, least, weights->interpolation_errors);
        for (uint32_t p = level->first_primitive; p < level->first_primitive + level->primitive_count; p++) {
            const struct asset_primitive *primitive = &file->primitives[p];
            for (uint32_t i = primitive->first_index; i < primitive->first_index + primitive->index_count; i += 3)
                errors[i / 3] +=
                    fmaxf(at_vertices[file->indices[i]], fmaxf(at_vertices[file->indices[i + 1]], at_vertices[file->indices[i + 2]]));
        }
        largest = find_erring(file, level, errors, erring);
    }
    for (int b = 0; b < WEIGHTS_ERRING; b++)
        weights->erring[b] = fmaxf(weights->erring[b], erring[b]);
    weights->largest_error = fmaxf(weights->largest_error, largest);
    raise_vertices(file, level, errors, least, weights->errors);
}

static void for_triangles(struct drawn_error_job *job, const struct asset_level *level, struct workers *workers, size_t grain,
                          void (*work)(void *arg, size_t begin, size_t end))
{
    const struct asset_view *file = &job->weights->layout->file->view;
    for (uint32_t p = level->first_primitive; p < level->first_primitive + level->primitive_count; p++) {
        job->first = file->primitives[p].first_index / 3;
        workers_for(workers, file->primitives[p].index_count / 3, grain, work, job);
    }
}

static void measure_ridges(void *arg, size_t begin, size_t end)
{
    const struct drawn_error_job *job = arg;
    ridges_measure(&(struct ridge_job){ job->weights, job->errors, job->ridges }, job->first + begin, job->first + end);
}

static bool loses_sensor(const struct weights *weights)
{
    for (size_t i = 0; i < weights->layout->sensor_count; i++)
        if (weights->configured[i] && !weights->takes_part[i])
            return true;
    return false;
}

/* Returns true if there is no data somewhere, because sensors reach a limited distance or a sensor is lost. */
static bool has_border(const struct weights *weights)
{
    return weights->reach_m < INFINITY || loses_sensor(weights);
}

/* Measures the errors of interpolation, and those at ridges, in the triangles of one level of detail. */
static void measure_triangles(struct drawn_error_job *job, const struct asset_level *level, struct workers *workers)
{
    job->has_border = has_border(job->weights);
    memset(job->needing, 0, sizeof(job->needing));
    for_triangles(job, level, workers, GRAIN, count_samples);
    choose_sampled(job);
    for_triangles(job, level, workers, GRAIN, measure_some);
    if (job->ridges)
        for_triangles(job, level, workers, RIDGE_GROUP, measure_ridges);
}

/* Measures all errors of one level of detail, for weights that are not prepared. resolved true: preparation left no interpolation error,
   so only the effect of errors in distances, and the border of the reach, are measured. Returns false when out of memory. */
static bool measure_level(struct drawn_error_job *job, const struct asset_level *level, bool resolved, struct workers *workers)
{
    struct weights *weights = job->weights;
    const struct field_layout *layout = weights->layout;
    size_t members = weights->member_count;
    uint32_t *numbers = mem_array(members, sizeof(*numbers));
    uint8_t *unmarked = mem_array(members, 1);
    double *ones = mem_array(members, sizeof(*ones));
    for (uint32_t m = 0; m < members; m++) {
        numbers[m] = m;
        ones[m] = 1;
    }
    job->members = numbers;
    job->ones = ones;
    job->members_marked = unmarked;
    const size_t blocks = (level->vertex_count + KERNEL_BLOCK - 1) / KERNEL_BLOCK;
    /* preparation cuts triangles at ridges, except for groups whose field is evaluated at each pixel with straight-line distances */
    const bool has_ridges =
        weights->distance != DISTANCE_EUCLIDEAN && (plant_group_is_exact(layout->group) || layout->trial || layout->file->cuts_differ);
    const bool amplifies = amplifies_distances(weights);
    if (has_ridges)
        job->ridges = mem_try_array(layout->file->view.header->index_count / 3, sizeof(float));
    if (amplifies)
        job->vertex_errors = mem_try_array(blocks * KERNEL_BLOCK, sizeof(float));
    if (amplifies && !weights->interpolation_errors)
        weights->interpolation_errors = mem_try_array(layout->vertex_count, sizeof(float));
    const bool has_memory = (job->ridges || !has_ridges) && ((job->vertex_errors && weights->interpolation_errors) || !amplifies);
    workers_for(workers, blocks, 4, prepare_some, weights);
    if (job->vertex_errors)
        workers_for(workers, blocks, 4, amplify_some, job);
    job->at_border_only = resolved;
    if (!resolved || weights->reach_m < INFINITY)
        measure_triangles(job, level, workers);
    spread(weights, job, level);
    mem_free(job->ridges);
    mem_free(job->vertex_errors);
    mem_free(numbers);
    mem_free(unmarked);
    mem_free(ones);
    return has_memory;
}

/* Measures the border of prepared weights' data in one level of detail. */
static void measure_border(struct drawn_error_job *job, const struct asset_level *level, struct workers *workers)
{
    const struct asset_view *file = &job->weights->layout->file->view;
    const size_t blocks = (level->vertex_count + KERNEL_BLOCK - 1) / KERNEL_BLOCK;
    workers_for(workers, blocks, 4, prepare_some, job->weights);
    job->at_border_only = true;
    measure_triangles(job, level, workers);
    /* the other errors of prepared weights are those that preparation measured */
    raise_vertices(file, level, job->errors, 0, job->weights->errors);
}

/* Marks the whole asset, because memory ran out while its errors were measured. */
static void mark_unknown(struct weights *weights)
{
    weights->errors_unknown = true;
    weights->largest_error = 1;
    for (int b = 0; b < WEIGHTS_ERRING; b++)
        weights->erring[b] = 1;
}

/* Returns true if the field has the same value everywhere, and data everywhere: it is that of one sensor without a limit of its
   reach, and no sensor is lost. */
static bool is_constant(const struct weights *weights)
{
    if (weights->member_count != 1 || weights->interpolation != INTERPOLATION_SHEPARD || weights->reach_m < INFINITY)
        return false;
    return !loses_sensor(weights);
}

/* Returns true if the subdivision chosen in preparation suffices (preprocess/subdivision/linear_error.h), because the weights
   are those that preparation assumed. With another power, or when sensors are missing, the field bends at other places, perhaps
   in larger triangles: with a power below 2, the field has a kink at each sensor. */
static bool is_as_prepared(const struct weights *weights, const struct field_params *params)
{
    const struct field_layout *layout = weights->layout;
    const struct plant_group *group = layout->group;
    if (layout->trial || params->override_count > 0 || params->distance == DISTANCE_HEAT || params->reach_m != group->reach_m)
        return false;
    /* false: this group's field is evaluated at each pixel of a picture, so preparation subdivided no triangle for it */
    if (plant_group_is_exact(group))
        return false;
    if (loses_sensor(weights))
        return false;
    if (params->interpolation == INTERPOLATION_SHEPARD)
        return params->power == group->power;
    return params->strength == 1 && params->decay == 1 && params->radius_m == group->radius_m &&
           plant_cuts_for_paper(group, layout->sensor_count);
}

void drawn_error_measure(struct weights *weights, const struct field_params *params, const uint8_t *usable, size_t vertices, bool in_range,
                         struct workers *workers)
{
    const struct field_layout *layout = weights->layout;
    const struct asset_view *file = &layout->file->view;
    uint32_t number = 0;
    while (number + 1 < file->header->level_count && file->levels[number + 1].vertex_count >= vertices)
        number++;
    uint64_t bit = (uint64_t)1 << (number < 63 ? number : 63);
    /* measures nothing if each pixel evaluates the field, because frames then do not interpolate within triangles */
    if (layout_is_exact(layout, weights->interpolation, weights->distance))
        return;
    if (layout->assumed || weights->member_count == 0 || is_constant(weights) || (weights->prepared && !has_border(weights)))
        return;
    const bool resolved = !weights->prepared && layout->file->resolved_levels & bit && in_range && is_as_prepared(weights, params);
    if (resolved && !amplifies_distances(weights) && !(weights->reach_m < INFINITY))
        return;
    if ((resolved ? weights->measured_levels : weights->sampled_levels) & bit)
        return;
    weights->measured_levels |= bit;
    weights->sampled_levels |= resolved ? 0 : bit;
    struct drawn_error_job job = { .weights = weights,
                                   .params = params,
                                   .usable = usable,
                                   .radius_m = weights->radius_m,
                                   .accepted = accepted_of(weights),
                                   .error_m = file->levels[number].error_m,
                                   .has_values = !weights->prepared,
                                   .errors = mem_try_array(file->header->index_count / 3, sizeof(float)) };
    weights->errors = weights->errors ? weights->errors : mem_try_array(layout->vertex_count, sizeof(float));
    weights->errors_version++;
    bool good = job.errors && weights->errors;
    if (good && weights->prepared)
        measure_border(&job, &file->levels[number], workers);
    else
        good = good && measure_level(&job, &file->levels[number], resolved, workers);
    if (!good)
        mark_unknown(weights);
    mem_free(job.errors);
}

void drawn_error_mark(struct weights *weights, const struct field_params *params, const uint8_t *usable, const struct drawn_near *near,
                      uint8_t *marks, struct workers *workers)
{
    const struct asset_view *file = &weights->layout->file->view;
    const size_t blocks = (weights->layout->vertex_count + KERNEL_BLOCK - 1) / KERNEL_BLOCK;
    struct drawn_error_job job = { .weights = weights,
                                   .params = params,
                                   .usable = usable,
                                   .radius_m = weights->radius_m,
                                   .near = near,
                                   .errors = mem_try_array(file->header->index_count / 3, sizeof(float)) };
    if (!job.errors) {
        memset(marks, 1, weights->layout->vertex_count);
        return;
    }
    workers_for(workers, blocks, 4, prepare_some, weights);
    for (uint32_t l = 0; l < file->header->level_count; l++) {
        job.error_m = file->levels[l].error_m;
        measure_triangles(&job, &file->levels[l], workers);
    }
    for (uint32_t i = 0; i < file->header->index_count; i++)
        if (job.errors[i / 3] > accepted_near(near))
            marks[file->indices[i]] = 1;
    mem_free(job.errors);
}
