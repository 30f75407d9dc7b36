/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Halves an asset's triangles again and again, and measures what that did to each part. */
#include <math.h>
#include <meshoptimizer.h>
#include <string.h>

#include "base/mem.h"
#include "preprocess/levels/levels_impl.h"

#define SHRINK 0.55     /* of the triangles of the version before, are asked for */
#define SHRINK_FAR 0.72 /* likewise where that has so many: levels that many instances are drawn with lie close together */
#define FAR_LEAST 2000
#define FAR_MOST 20000
#define STUCK 0.9          /* likewise; a version with more is the last */
#define LEAST_TRIANGLES 60 /* fewer are not simplified */
#define NEAR 0.01          /* of the size: versions that err less keep open borders as they are, or hair gaps between patches would open */
#define BEYOND 3.0         /* times the simplifier's own error, which is a mean over planes and no bound, is about what comes out */

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

static double shrink_of(const struct version *from)
{
    size_t tris = from->count / 3;
    return tris >= FAR_LEAST && tris <= FAR_MOST ? SHRINK_FAR : SHRINK;
}

static size_t simplify(const struct welds *welds, const struct version *from, uint32_t *to, unsigned options, float *error)
{
    size_t target = (size_t)(shrink_of(from) * (double)(from->count / 3)) * 3;
    return meshopt_simplify(to, from->welds, from->count, &welds->positions_m[0][0], welds->count, sizeof(*welds->positions_m), target, 1,
                            options, error);
}

/* Halves the last version. Returns the simplifier's own error, in metres. */
static double halve(struct version *to, const struct version *from, const struct welds *welds)
{
    float error = 0;
    double scale_m = (double)meshopt_simplifyScale(&welds->positions_m[0][0], welds->count, sizeof(*welds->positions_m));
    to->count = simplify(welds, from, to->welds, meshopt_SimplifyLockBorder, &error);
    if ((double)to->count > 1.1 * shrink_of(from) * (double)from->count || (double)error * scale_m > NEAR * welds->whole_m)
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
    while (versions->count < VERSIONS_MAX && triangles_of(versions) > LEAST_TRIANGLES) {
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

void versions_finish(struct versions *versions)
{
    while (versions->count)
        drop_last(versions);
    deviation_finish(&versions->first);
}
