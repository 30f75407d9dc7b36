/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares the distances computed by propagation with those of the heat method (surface_check()). */
#include <stdatomic.h>
#include <string.h>

#include "base/clock.h"
#include "base/math/vec.h"
#include "base/mem.h"
#include "surface/geodesic/heat.h"
#include "surface/surface_impl.h"

#define TIME_OF_SPACING 3.0 /* diffusion time t of the heat method, in multiples of the squared mean edge length */
/* lower limit of the diffusion time t: sqrt(t) is at least twice the size of the surface (its largest distance) divided by
   MAX_DECAY. Heat falls exponentially with distance / sqrt(t), and would underflow on large surfaces with a smaller t */
#define MAX_DECAY 500.0
#define MAX_SOURCES 32 /* number of sources (points from which distances are computed) that are checked, spread evenly over all sources */
#define BLOCK 8        /* number of sources (points from which distances are computed) for which the heat method solves at a time */

/* Returns the approximate size of the surface: in the component with most triangles, the distance from an arbitrary point to the point
 * farthest from it. */
static double reach_of(const struct surface *surface)
{
    const struct trimesh *mesh = &surface->visible;
    uint32_t *counts = mem_array(mesh->point_count, sizeof(*counts));
    uint32_t best = 0;
    for (uint32_t t = 0; t < mesh->tri_count; t++)
        if (++counts[surface->component[mesh->tris[t][0]]] > counts[surface->component[mesh->tris[best][0]]])
            best = t;
    struct propagation_front front = { 0 };
    double reach_m = 0;
    if (propagation_run(&surface->propagation, &front, &(struct propagation_source){ best, (const double[3]){ 1, 0, 0 } }, 1))
        for (size_t i = 0; i < mesh->point_count; i++)
            if (front.distance_m[i] < INFINITY)
                reach_m = max_of(reach_m, (double)front.distance_m[i]);
    propagation_front_finish(&front);
    mem_free(counts);
    return reach_m;
}

/* Returns the root mean square difference between the distances of the two methods, relative to the largest distance. Heat
 * distances have a free constant, chosen so that the two methods agree on average. The heat method smooths ridges and borders
 * over about sqrt(t), so a few percent at single points are normal. More indicates that the surface is not connected the way it
 * looks. */
static double disagreement_of(const struct propagation *propagation, const struct surface_field *field, size_t source, const double *heat_m)
{
    double sum = 0, squares = 0, largest_m = 0, count = 0;
    for (size_t p = 0; p < propagation->mesh->point_count; p++) {
        double walked_m = (double)field->distances_m[p * field->source_count + source], difference_m = walked_m - heat_m[p];
        if (propagation->hidden[p] || walked_m == INFINITY)
            continue;
        count++;
        sum += difference_m;
        squares += difference_m * difference_m;
        largest_m = max_of(largest_m, walked_m);
    }
    double mean = sum / count;
    return largest_m > 0 ? sqrt(max_of(squares / count - mean * mean, 0)) / largest_m : 0;
}

struct field_check {
    const struct surface *surface;
    const struct surface_field *field;
    const struct heat *heat;
    size_t count;
    double *disagreement; /* per source checked */
    atomic_bool failed;
};

static size_t source_of(const struct field_check *check, size_t i)
{
    return i * check->field->source_count / check->count;
}

static void check_block(void *arg, size_t begin, size_t end)
{
    struct field_check *check = arg;
    const struct surface *surface = check->surface;
    size_t points = surface->mesh.point_count, count = end - begin;
    struct heat_source *sources = mem_array(count, sizeof(*sources));
    double *heat_m = mem_try_array(count * points, sizeof(*heat_m));
    for (size_t s = 0; s < count; s++) {
        const struct surface_point *hit = &check->field->sources[source_of(check, begin + s)];
        memcpy(sources[s].points, surface->visible.tris[hit->tri], sizeof(sources[s].points));
        memcpy(sources[s].weights, hit->weights, sizeof(sources[s].weights));
    }
    if (!heat_m || !heat_solve(check->heat, sources, count, heat_m))
        check->failed = true;
    for (size_t s = 0; s < count && !check->failed; s++)
        check->disagreement[begin + s] =
            disagreement_of(&surface->propagation, check->field, source_of(check, begin + s), heat_m + s * points);
    mem_free(sources);
    mem_free(heat_m);
}

bool surface_check(struct surface *surface, const struct surface_field *field)
{
    struct surface_report *report = &surface->report;
    struct field_check check = { .surface = surface, .field = field };
    int64_t start_ns = clock_mono_ns(), factored_ns;
    if (!surface->component) {
        surface->component = mem_array(surface->mesh.point_count, sizeof(*surface->component));
        trimesh_components(&surface->visible, surface->component);
    }
    double decay_m = max_of(sqrt(TIME_OF_SPACING) * surface->edge_m, 2 * reach_of(surface) / MAX_DECAY);
    struct heat *heat = heat_create(surface->log, &surface->intrinsic, surface->component, decay_m * decay_m);
    factored_ns = clock_mono_ns();
    if (!heat)
        return false;
    check.heat = heat;
    check.count = field->source_count < MAX_SOURCES ? field->source_count : MAX_SOURCES;
    check.disagreement = mem_array(check.count, sizeof(*check.disagreement));
    if (surface->workers)
        workers_for(surface->workers, check.count, BLOCK, check_block, &check);
    else
        check_block(&check, 0, check.count);
    heat_destroy(&heat);
    report->heat_disagreement = 0;
    for (size_t i = 0; i < check.count; i++)
        report->heat_disagreement = max_of(report->heat_disagreement, check.disagreement[i]);
    report->time_m2 = decay_m * decay_m;
    report->factor_s = (double)(factored_ns - start_ns) / NS_PER_S;
    report->check_s = (double)(clock_mono_ns() - factored_ns) / NS_PER_S;
    if (check.failed)
        log_err(surface->log, "cannot check the distances from %zu sensors along an asset's surface: out of memory", check.count);
    mem_free(check.disagreement);
    return !check.failed;
}
