/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Simplifies an asset step by step into versions, and measures the error of each part (connected component) in each version. An
 * asset with many triangles is first simplified as a whole (meshoptimizer), to about half the triangles per step, then part by
 * part, by edge collapses. */
#include <math.h>
#include <meshoptimizer.h>
#include <string.h>

#include "base/mem.h"
#include "preprocess/levels/levels_bounded.h"
#include "preprocess/levels/levels_impl.h"

#define SHRINK 0.55 /* target triangle count of a version (simplification step), as a share of the previous version's */
/* stop simplifying the asset as a whole at a version (simplification step) that keeps more than this share of the previous
 * version's triangles */
#define STUCK 0.9
/* number of triangles above which the asset is simplified as a whole, which is fast; with fewer, it is simplified part by part
   (levels_bounded.c) */
#define HALVE_ABOVE 40000
/* number of triangles above which the asset is never simplified part by part, even if simplifying it as a whole makes no more
   progress */
#define MAX_COLLAPSED 100000
/* allowed error of the first version (simplification step) made by edge collapses, relative to the asset's size */
#define LEAST 0.00025
/* ratio of the allowed errors of successive versions (simplification steps) in the range of far levels (levels.c) */
#define STEP 1.3
/* ratio of the allowed errors of successive versions (simplification steps) in the range of near levels; larger, because each
 * version must be measured and near levels need fewer versions */
#define STEP_ELSE 1.7
#define ALIKE 0.85       /* a version (simplification step) with more than this share of the previous one's triangles is dropped */
#define MIN_TRIANGLES 60 /* assets with fewer triangles are not simplified */
/* versions (simplification steps) with an error below this, relative to the asset's size, keep open borders, so that no hair
 * gaps open between patches */
#define NEAR 0.01
/* meshoptimizer estimates the error as a mean over planes; this factor converts the estimate to the maximum error that will
   probably be measured */
#define BEYOND 3.0

static size_t triangles_of(const struct versions *versions)
{
    return versions->at[versions->count - 1].count / 3;
}

static struct version *add_version(struct versions *versions, const struct welds *welds, size_t capacity)
{
    struct version *version = &versions->at[versions->count++];
    version->welds = mem_array(capacity, sizeof(*version->welds));
    version->error_m = mem_array(welds->part_count, sizeof(*version->error_m));
    version->tris = mem_array(welds->part_count, sizeof(*version->tris));
    return version;
}

static void count_tris(struct version *version, const struct welds *welds)
{
    for (size_t i = 0; i < version->count; i += 3)
        version->tris[welds->part[version->welds[i]]]++;
}

static size_t simplify(const struct welds *welds, const struct version *from, uint32_t *to, unsigned options, float *error)
{
    size_t target = (size_t)(SHRINK * (double)(from->count / 3)) * 3;
    return meshopt_simplify(to, from->welds, from->count, &welds->positions_m[0][0], welds->count, sizeof(*welds->positions_m), target, 1,
                            options, error);
}

/* Simplifies the version (simplification step) `from` to about half its triangles. Returns meshoptimizer's error estimate in metres. */
static double halve(struct version *to, const struct version *from, const struct welds *welds)
{
    float error = 0;
    double scale_m = (double)meshopt_simplifyScale(&welds->positions_m[0][0], welds->count, sizeof(*welds->positions_m));
    to->count = simplify(welds, from, to->welds, meshopt_SimplifyLockBorder, &error);
    if ((double)to->count > 1.1 * SHRINK * (double)from->count || (double)error * scale_m > NEAR * welds->whole_m)
        to->count = simplify(welds, from, to->welds, 0, &error);
    return (double)error * scale_m;
}

void levels_surface(struct deviation *surface, const struct welds *welds, const char *only, const uint32_t *corners, size_t count)
{
    deviation_init(surface,
                   &(struct deviation_params){ .positions_m = (const float(*)[3])welds->positions_m,
                                               .first_there = welds->first_there,
                                               .part = welds->part,
                                               .part_count = welds->part_count,
                                               .only = only },
                   corners, count / 3);
}

static void measure(struct version *version, const struct version *before, const struct welds *welds, const struct deviation *first,
                    double expected_m, struct workers *workers)
{
    struct deviation surface;
    char *changed = mem_array(welds->part_count, 1);
    memcpy(version->error_m, before->error_m, welds->part_count * sizeof(*version->error_m));
    for (size_t p = 0; p < welds->part_count; p++)
        changed[p] = version->tris[p] != before->tris[p] && (double)before->error_m[p] <= LEVELS_FARTHEST * welds->whole_m;
    levels_surface(&surface, welds, changed, version->welds, version->count);
    deviation_measure(&surface, first, changed, expected_m, version->error_m, workers);
    deviation_measure(first, &surface, changed, expected_m, version->error_m, workers);
    deviation_finish(&surface);
    mem_free(changed);
}

static void drop_last(struct versions *versions)
{
    struct version *version = &versions->at[--versions->count];
    mem_free(version->welds);
    mem_free(version->error_m);
    mem_free(version->tris);
    *version = (struct version){ 0 };
}

/* --- edge by edge -------------------------------------------------------------------------------------------------------------- */

struct collapsing {
    const struct welds *welds;
    const struct deviation *first;
    const struct version *from;
    struct bounded **parts; /* by part (connected component): its edge collapser (levels_bounded.h); NULL: the part has no triangles left */
    size_t *first_corner;   /* by part: index in `corners` of its first triangle in the version (simplification step) `from` */
    uint32_t *corners;
    size_t *first_place; /* by part (connected component): index in `places` of its first vertex in the original model */
    uint32_t *places;
    double error_m; /* allowed error of the version being made, metres */
};

/* Counting sort: turns the count of part p at [p + 2] into its start offset at [p + 1]. Filling then advances each offset at [p + 1] to the
 * start of the next part, so that [p] is the start of part p. */
static void add_up(size_t *first, size_t parts)
{
    for (size_t p = 2; p < parts + 2; p++)
        first[p] += first[p - 1];
}

static void sort_by_part(struct collapsing *collapsing)
{
    const struct version *from = collapsing->from;
    const struct deviation *first = collapsing->first;
    const uint32_t *part = collapsing->welds->part;
    size_t parts = collapsing->welds->part_count, points = first->mesh.point_count;
    collapsing->first_corner = mem_array(parts + 2, sizeof(*collapsing->first_corner));
    collapsing->first_place = mem_array(parts + 2, sizeof(*collapsing->first_place));
    collapsing->corners = mem_array(from->count, sizeof(*collapsing->corners));
    collapsing->places = mem_array(points, sizeof(*collapsing->places));
    for (size_t i = 0; i < from->count; i++)
        collapsing->first_corner[part[from->welds[i]] + 2]++;
    for (size_t i = 0; i < points; i++)
        collapsing->first_place[part[first->index[i]] + 2]++;
    add_up(collapsing->first_corner, parts);
    add_up(collapsing->first_place, parts);
    for (size_t i = 0; i < from->count; i++)
        collapsing->corners[collapsing->first_corner[part[from->welds[i]] + 1]++] = from->welds[i];
    for (size_t i = 0; i < points; i++)
        collapsing->places[collapsing->first_place[part[first->index[i]] + 1]++] = first->index[i];
}

static void begin_parts(void *arg, size_t begin, size_t end)
{
    const struct collapsing *collapsing = arg;
    for (size_t p = begin; p < end; p++) {
        size_t corner = collapsing->first_corner[p], place = collapsing->first_place[p];
        if (collapsing->from->tris[p] > 0)
            collapsing->parts[p] = bounded_create(collapsing->welds, collapsing->corners + corner, collapsing->first_corner[p + 1] - corner,
                                                  collapsing->places + place, collapsing->first_place[p + 1] - place,
                                                  deviation_hierarchy(collapsing->first, p));
    }
}

static void simplify_parts(void *arg, size_t begin, size_t end)
{
    const struct collapsing *collapsing = arg;
    for (size_t p = begin; p < end; p++)
        if (collapsing->parts[p])
            bounded_simplify(collapsing->parts[p], collapsing->error_m);
}

static void read_parts(const struct collapsing *collapsing, struct version *version)
{
    for (size_t p = 0; p < collapsing->welds->part_count; p++)
        if (collapsing->parts[p]) {
            bounded_read(collapsing->parts[p], version->welds + version->count);
            version->count += 3 * bounded_count(collapsing->parts[p]);
        }
}

/* Lists the allowed errors for the versions (simplification steps) made by edge collapses: at most `room`, chosen from the
 * largest useful error down, and sorted in ascending order. Returns their number. */
static size_t list_errors(double whole_m, size_t room, double errors_m[VERSIONS_MAX])
{
    size_t count = 0;
    for (double error = LEVELS_FARTHEST; error >= LEAST && count < room; count++) {
        errors_m[count] = error * whole_m;
        error /= error > LEVELS_FILLING && error <= LEVELS_SMALL ? STEP : STEP_ELSE;
    }
    for (size_t i = 0; i < count / 2; i++) {
        double last = errors_m[count - 1 - i];
        errors_m[count - 1 - i] = errors_m[i];
        errors_m[i] = last;
    }
    return count;
}

/* Makes versions (simplification steps) by edge collapses, one for each allowed error. */
static void make_collapsed(struct versions *versions, const struct welds *welds, struct workers *workers)
{
    struct collapsing collapsing = { .welds = welds, .first = &versions->first, .from = &versions->at[versions->count - 1] };
    collapsing.parts = mem_array(welds->part_count, sizeof(*collapsing.parts));
    sort_by_part(&collapsing);
    workers_for(workers, welds->part_count, 1, begin_parts, &collapsing);
    double errors_m[VERSIONS_MAX];
    size_t count = list_errors(welds->whole_m, VERSIONS_MAX - versions->count, errors_m);
    for (size_t i = 0; i < count; i++) {
        collapsing.error_m = errors_m[i];
        const struct version *before = &versions->at[versions->count - 1];
        struct version *version = add_version(versions, welds, before->count);
        workers_for(workers, welds->part_count, 1, simplify_parts, &collapsing);
        read_parts(&collapsing, version);
        if ((double)version->count > ALIKE * (double)before->count && i + 1 < count) {
            drop_last(versions);
            continue;
        }
        count_tris(version, welds);
        measure(version, before, welds, &versions->first, collapsing.error_m, workers);
    }
    for (size_t p = 0; p < welds->part_count; p++)
        bounded_destroy(&collapsing.parts[p]);
    mem_free(collapsing.parts);
    mem_free(collapsing.first_corner);
    mem_free(collapsing.first_place);
    mem_free(collapsing.corners);
    mem_free(collapsing.places);
}

static void make_halves(struct versions *versions, const struct welds *welds, struct workers *workers)
{
    while (versions->count < VERSIONS_MAX && triangles_of(versions) > HALVE_ABOVE) {
        const struct version *before = &versions->at[versions->count - 1];
        struct version *version = add_version(versions, welds, before->count);
        double error_m = halve(version, before, welds);
        if (version->count == 0 || (double)version->count > STUCK * (double)before->count) {
            drop_last(versions);
            break;
        }
        count_tris(version, welds);
        measure(version, before, welds, &versions->first, fmax(BEYOND * error_m, 1e-5 * welds->whole_m), workers);
    }
}

void versions_make(struct versions *versions, const struct welds *welds, struct workers *workers)
{
    const struct geometry *g = welds->geometry;
    versions->count = 0;
    struct version *model = add_version(versions, welds, g->index_count);
    model->count = g->index_count;
    for (size_t i = 0; i < model->count; i++)
        model->welds[i] = welds->of_vertex[g->indices[i]];
    count_tris(model, welds);
    levels_surface(&versions->first, welds, NULL, model->welds, model->count);
    make_halves(versions, welds, workers);
    if (triangles_of(versions) > MIN_TRIANGLES && triangles_of(versions) <= MAX_COLLAPSED)
        make_collapsed(versions, welds, workers);
}

void versions_finish(struct versions *versions)
{
    while (versions->count)
        drop_last(versions);
    deviation_finish(&versions->first);
}
