/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Separates a model's main part from stray pieces: splits its triangles at gaps along the axes, found in histograms. */
#include "base/math/gap_split.h"

#include <math.h>
#include <stdbool.h>

#include "base/mem.h"
#include "base/math/vec.h"

enum { BINS = 256, MAX_SPLITS = 64 };
static const double SMALL_SHARE = 0.02; /* stray pieces are small if together they have at most this fraction of the total area */
/* minimum length of a gap, as a multiple of the main part's size. Beyond a gap of SMALL_GAP, only small pieces (SMALL_SHARE)
   count as stray; beyond a gap of LARGE_GAP, pieces of any area do */
static const double SMALL_GAP = 1, LARGE_GAP = 100;
/* corners of triangles farther apart than this fraction of the main part's size count as different places */
static const double ONE_PLACE = 1e-3;

struct tri_range {
    struct gap_tri *tris;
    size_t count;
};

static void box_of(const struct gap_tri *tris, size_t count, double min_m[3], double max_m[3])
{
    for (int c = 0; c < 3; c++) {
        min_m[c] = INFINITY;
        max_m[c] = -INFINITY;
        for (size_t t = 0; t < count; t++)
            for (int k = 0; k < 3; k++) {
                min_m[c] = fmin(min_m[c], tris[t].at[k][c]);
                max_m[c] = fmax(max_m[c], tris[t].at[k][c]);
            }
    }
}

static double size_of(const struct gap_tri *tris, size_t count)
{
    double min_m[3], max_m[3], size_m = 0;
    box_of(tris, count, min_m, max_m);
    for (int c = 0; c < 3; c++)
        size_m = fmax(size_m, max_m[c] - min_m[c]);
    return size_m;
}

/* Finds the widest interval along an axis that contains no corner of a triangle. Returns its length; 0: there is none. */
static double find_gap(const struct tri_range *part, int axis, double min_m, double max_m, double *from_m, double *to_m)
{
    struct {
        double low_m, high_m;
    } bins[BINS];
    double last_m = min_m, gap_m = 0;
    if (!(max_m > min_m))
        return 0;
    for (int b = 0; b < BINS; b++)
        bins[b].low_m = INFINITY, bins[b].high_m = -INFINITY;
    for (size_t t = 0; t < part->count; t++)
        for (int k = 0; k < 3; k++) {
            double x = part->tris[t].at[k][axis];
            int b = (int)fmin(BINS * ((x - min_m) / (max_m - min_m)), BINS - 1);
            bins[b].low_m = fmin(bins[b].low_m, x);
            bins[b].high_m = fmax(bins[b].high_m, x);
        }
    for (int b = 0; b < BINS; b++) {
        if (!(bins[b].low_m <= bins[b].high_m))
            continue;
        if (bins[b].low_m - last_m > gap_m) {
            gap_m = bins[b].low_m - last_m;
            *from_m = last_m;
            *to_m = bins[b].low_m;
        }
        last_m = bins[b].high_m;
    }
    return gap_m;
}

static void swap(struct gap_tri *a, struct gap_tri *b)
{
    struct gap_tri copy = *a;
    *a = *b;
    *b = copy;
}

/* Moves the triangles that are entirely on one side of the gap to the front of the array. Returns their number. */
static size_t gather(struct tri_range *part, int axis, double from_m, double to_m, bool above, double *area_m2)
{
    size_t count = 0;
    *area_m2 = 0;
    for (size_t t = 0; t < part->count; t++) {
        int inside = 0;
        for (int k = 0; k < 3; k++)
            inside += above ? part->tris[t].at[k][axis] >= to_m : part->tris[t].at[k][axis] <= from_m;
        if (inside < 3)
            continue;
        *area_m2 += part->tris[t].area_m2;
        swap(&part->tris[t], &part->tris[count++]);
    }
    return count;
}

/* Returns true if triangles cross the gap and their corners on its far side are more than within_m apart: they then connect the
   main part with a real part of the model, not with one stray point. */
static bool reach_several_places(const struct gap_tri *tris, size_t count, int axis, double from_m, double to_m, bool above,
                                 double within_m)
{
    struct extent extent = extent_empty();
    for (size_t t = 0; t < count; t++) {
        int beyond = 0;
        for (int k = 0; k < 3; k++)
            beyond += above ? tris[t].at[k][axis] <= from_m : tris[t].at[k][axis] >= to_m;
        for (int k = 0; k < 3 && beyond > 0 && beyond < 3; k++)
            if (above ? tris[t].at[k][axis] <= from_m : tris[t].at[k][axis] >= to_m)
                extent_add(&extent, tris[t].at[k]);
    }
    return extent.low[0] <= extent.high[0] && extent_size(&extent) > within_m;
}

/* Drops the triangles beyond one gap from `part`. Returns false if no gap separates stray pieces. */
static bool split(struct tri_range *part, double all_m2)
{
    double min_m[3], max_m[3];
    box_of(part->tris, part->count, min_m, max_m);
    for (int axis = 0; axis < 3; axis++) {
        double from_m, to_m, low_m2, high_m2;
        double gap_m = find_gap(part, axis, min_m[axis], max_m[axis], &from_m, &to_m);
        if (!(gap_m > 0))
            continue;
        size_t low = gather(part, axis, from_m, to_m, false, &low_m2), high = gather(part, axis, from_m, to_m, true, &high_m2);
        bool above = high_m2 > low_m2 || (high_m2 == low_m2 && high > low);
        double kept_m2, crossing_m2 = -low_m2 - high_m2;
        size_t kept = gather(part, axis, from_m, to_m, above, &kept_m2);
        double size_m = size_of(part->tris, kept), lost_m2 = all_m2 - kept_m2;
        for (size_t t = 0; t < part->count; t++)
            crossing_m2 += part->tris[t].area_m2;
        if (crossing_m2 > SMALL_SHARE * all_m2 &&
            reach_several_places(part->tris + kept, part->count - kept, axis, from_m, to_m, above, ONE_PLACE * size_m))
            continue;
        if (kept > 0 && size_m > 0 && gap_m >= (lost_m2 <= SMALL_SHARE * all_m2 ? SMALL_GAP : LARGE_GAP) * size_m) {
            part->count = kept;
            return true;
        }
    }
    return false;
}

size_t gap_split(struct gap_tri *tris, size_t count, struct extent *main)
{
    struct tri_range part = { tris, count };
    double all_m2 = 0;
    int splits = 0;
    for (size_t t = 0; t < count; t++)
        all_m2 += tris[t].area_m2;
    while (splits < MAX_SPLITS && part.count > 0 && split(&part, all_m2))
        splits++;
    box_of(tris, part.count, main->low, main->high);
    return part.count;
}

struct gap_tri *gap_tris(const float (*positions_m)[3], const uint32_t *indices, size_t triangle_count)
{
    struct gap_tri *tris = mem_array(triangle_count, sizeof(*tris));
    for (size_t t = 0; t < triangle_count; t++) {
        double normal[3];
        for (size_t k = 0; k < 3; k++)
            for (int axis = 0; axis < 3; axis++)
                tris[t].at[k][axis] = (double)positions_m[indices[3 * t + k]][axis];
        vec_normal(tris[t].at[0], tris[t].at[1], tris[t].at[2], normal);
        tris[t].area_m2 = 0.5 * vec_length(normal);
        tris[t].owner = (uint32_t)t;
    }
    return tris;
}

double gap_main_size(const float (*positions_m)[3], const uint32_t *indices, size_t triangle_count)
{
    struct gap_tri *tris = gap_tris(positions_m, indices, triangle_count);
    struct extent extent = extent_empty();
    gap_split(tris, triangle_count, &extent);
    mem_free(tris);
    return extent_size(&extent);
}
