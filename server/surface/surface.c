/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds the surface for computing distances from a model's triangles: welds vertices, repairs cracks, samples (surface.h). */
#include "surface/surface.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/math/gap_split.h"
#include "base/math/vec.h"
#include "base/mem.h"
#include "surface/repair/interior.h"
#include "surface/mesh/short_sides.h"
#include "surface/mesh/spatial_order.h"
#include "surface/repair/parts.h"
#include "surface/repair/repair.h"
#include "surface/surface_impl.h"
#include "surface/mesh/decimate.h"

/* vertices closer than this, relative to the model's size, are welded (treated as one): the resolution of float positions */
#define WELD_OF_SIZE 1e-6
#define TOLERANCE_OF_SIZE 5e-4
/* number of points that sampling (adding points until edges are short) should add to the model's vertices */
#define SAMPLES 15000.0
#define SPACING_GROWTH 1.25    /* if sampling adds too many points, it is repeated with a maximum edge length larger by this factor */
#define POINTS_PER_SPACING 2.7 /* number of points that halving edges adds in a square whose side is the maximum edge length; measured */

static double seconds_since(int64_t *since_ns)
{
    int64_t now_ns = clock_mono_ns();
    double seconds = (double)(now_ns - *since_ns) / NS_PER_S;
    *since_ns = now_ns;
    return seconds;
}

static size_t border_edges(const struct trimesh *mesh)
{
    struct edge_table edges;
    edge_table_init(&edges, mesh->tri_count * 3 / 2);
    unsigned char *faces = mem_array(mesh->tri_count * 3, 1);
    size_t count = 0;
    for (size_t t = 0; t < mesh->tri_count; t++) {
        edge_table_prefetch_ahead(&edges, (const uint32_t(*)[3])mesh->tris, t, mesh->tri_count);
        for (int i = 0; i < 3; i++) {
            uint32_t e = edge_table_add(&edges, mesh->tris[t][i], mesh->tris[t][(i + 1) % 3]);
            faces[e] = (unsigned char)(faces[e] < 2 ? faces[e] + 1 : 2);
        }
    }
    for (size_t e = 0; e < edges.count; e++)
        count += faces[e] == 1;
    mem_free(faces);
    edge_table_finish(&edges);
    return count;
}

static size_t components_of(const struct trimesh *mesh)
{
    uint32_t *component = mem_array(mesh->point_count, sizeof(*component));
    size_t count = trimesh_components(mesh, component);
    mem_free(component);
    return count;
}

static bool no_surface(const struct surface *surface, char *why, const char *fmt, ...) __attribute__((format(printf, 3, 4)));
static bool no_surface(const struct surface *surface, char *why, const char *fmt, ...)
{
    char text[SURFACE_WHY_BYTES];
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(text, sizeof(text), fmt, ap);
    va_end(ap);
    if (why)
        memcpy(why, text, sizeof(text));
    else
        log_err(surface->log, "cannot build the surface of an asset from its %zu vertices: %s", surface->vertex_count, text);
    return false;
}

static bool weld(struct surface *surface, const float (*positions)[3], const uint32_t *triangles, size_t triangle_count, double size_m,
                 char *why)
{
    struct surface_report *report = &surface->report;
    surface->vertex_point = mem_try_array(surface->vertex_count, sizeof(*surface->vertex_point));
    if (!surface->vertex_point ||
        !trimesh_weld(&surface->mesh, &(struct trimesh_model){ positions, surface->vertex_count, triangles, triangle_count },
                      size_m * WELD_OF_SIZE, surface->vertex_point, &report->degenerate_triangles, &report->repeated_triangles))
        return no_surface(surface, why, "out of memory");
    report->triangles = triangle_count;
    report->welded_vertices = surface->mesh.point_count;
    report->border_edges = border_edges(&surface->mesh);
    report->components = components_of(&surface->mesh);
    return surface->mesh.tri_count > 0 ||
           no_surface(
               surface, why,
               "none of the asset's %zu triangles has an area after points within %g m of each other are merged: check the model's unit",
               triangle_count, size_m * WELD_OF_SIZE);
}

static void follow(struct surface *surface, const uint32_t *target)
{
    for (size_t v = 0; v < surface->vertex_count; v++)
        surface->vertex_point[v] = target[surface->vertex_point[v]];
}

static void note_bridges(struct surface *surface, struct repair_report *made)
{
    struct surface_report *report = &surface->report;
    mem_grow(&surface->bridges, &surface->bridge_capacity, surface->bridge_count + made->made_count, sizeof(*surface->bridges));
    if (made->made_count)
        memcpy(surface->bridges + surface->bridge_count, made->made, made->made_count * sizeof(*made->made));
    surface->bridge_count += made->made_count;
    mem_free(made->made);
    report->bridges += made->bridges;
    report->longest_bridge_m = max_of(report->longest_bridge_m, made->longest_m);
    report->k = report->k > made->k ? report->k : made->k;
}

static bool close_seams(struct surface *surface, char *why)
{
    struct repair_report made = { 0 };
    uint32_t *target = mem_array(surface->mesh.point_count, sizeof(*target));
    repair_seams(&surface->mesh, surface->report.tolerance_m, target, &made);
    follow(surface, target);
    note_bridges(surface, &made);
    mem_free(target);
    return made.k >= 0 ||
           no_surface(surface, why, "cannot build the surface of an asset: out of memory while closing gaps between %zu surface points",
                      surface->mesh.point_count);
}

/* Moves visible triangles to the front of the mesh, and hidden[] with them. Returns the number of visible triangles. */
static size_t sort_hidden(struct trimesh *mesh, char *hidden)
{
    size_t front = 0;
    for (size_t t = 0; t < mesh->tri_count; t++) {
        if (hidden[t])
            continue;
        for (int i = 0; i < 3; i++) {
            uint32_t swap = mesh->tris[t][i];
            mesh->tris[t][i] = mesh->tris[front][i];
            mesh->tris[front][i] = swap;
        }
        uint32_t swap = mesh->tri_source[t];
        mesh->tri_source[t] = mesh->tri_source[front];
        mesh->tri_source[front] = swap;
        hidden[t] = hidden[front];
        hidden[front++] = 0;
    }
    return front;
}

/* Merges crossing points (mesh repair inserts one where an edge passes through a face) at the same position. Where two edges cross, repair
   made a separate point for each face; two points would leave a crack in the surface. */
static void merge_twins(struct surface *surface, uint32_t *crossings, size_t crossing_count)
{
    uint32_t *target = mem_array(surface->mesh.point_count, sizeof(*target));
    size_t degenerate = 0, repeated = 0;
    if (trimesh_find_twins(&surface->mesh, surface->report.size_m * WELD_OF_SIZE, target)) {
        trimesh_rename(&surface->mesh, target, &degenerate, &repeated);
        follow(surface, target);
        for (size_t i = 0; i < crossing_count; i++)
            crossings[i] = target[crossings[i]];
    }
    mem_free(target);
}

/* Removes points that repair inserted and that are not needed (decimate.h). Points with an index below `added` stay: they are the model's
   own points and the samples. */
static void decimate(struct surface *surface, const uint32_t *part, size_t added, char *hidden)
{
    struct trimesh *mesh = &surface->mesh;
    uint32_t *target = mem_array(mesh->point_count, sizeof(*target));
    char *keep = mem_array(mesh->point_count, 1);
    for (size_t p = 0; p < added; p++)
        keep[p] = 1;
    for (size_t v = 0; v < surface->vertex_count; v++)
        keep[surface->vertex_point[v]] = 1;
    decimate_mesh(mesh, hidden,
                  &(struct decimate_params){ .part = part,
                                             .keep = keep,
                                             .within_m = surface->report.size_m * WELD_OF_SIZE / 4,
                                             .longest_m = surface->report.spacing_m },
                  surface->plane, surface->report.triangles, target);
    follow(surface, target);
    mem_free(target);
    mem_free(keep);
}

/* Closes rims: edges that became open because triangles at them were hidden. */
static void close_rims(struct surface *surface, const struct body_parts *parts, char **hidden)
{
    struct repair_report made = { 0 };
    uint32_t *target = mem_array(surface->mesh.point_count, sizeof(*target));
    size_t seen = repair_rims(&surface->mesh, *hidden, parts, target, &made);
    follow(surface, target);
    note_bridges(surface, &made);
    mem_free(target);
    mem_free(*hidden);
    *hidden = mem_array(surface->mesh.tri_count, 1);
    memset(*hidden + seen, 1, surface->mesh.tri_count - seen);
}

static void join_parts(struct surface *surface, struct body_parts *parts)
{
    struct repair_report made = { 0 };
    size_t own = surface->mesh.point_count;
    uint32_t *target = mem_array(own, sizeof(*target));
    repair_contacts(&surface->mesh, parts, target, &made);
    follow(surface, target);
    note_bridges(surface, &made);
    mem_free(target);
    merge_twins(surface, made.crossings, made.crossing_count);
    char *hidden = mem_array(surface->mesh.tri_count, 1);
    uint32_t *part = parts_spread(&surface->mesh, parts->of_source);
    if (interior_find(&surface->mesh, part, parts, made.crossings, made.crossing_count, surface->workers, hidden)) {
        interior_islands(&surface->mesh, hidden);
        close_rims(surface, parts, &hidden);
        mem_free(part);
        part = parts_spread(&surface->mesh, parts->of_source);
    }
    decimate(surface, part, own, hidden);
    size_t visible_count = sort_hidden(&surface->mesh, hidden);
    target = mem_array(surface->mesh.point_count, sizeof(*target));
    spatial_order_mesh(&surface->mesh, visible_count, target);
    follow(surface, target);
    surface->visible = surface->mesh;
    surface->visible.tri_count = visible_count;
    mem_free(target);
    mem_free(part);
    mem_free(hidden);
    mem_free(made.crossings);
}

/* Moves triangles that reach from the asset's main part to a stray vertex (one far from all others) to the end of the mesh.
 * These have an edge longer than the main part. Returns the number of moved triangles. */
static size_t set_aside_needles(struct surface *surface)
{
    struct trimesh *mesh = &surface->mesh;
    char *aside = mem_array(mesh->tri_count, 1);
    double longest_m = surface->report.size_m * (1 + WELD_OF_SIZE);
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++)
            aside[t] |= vec_distance(mesh->points[mesh->tris[t][i]], mesh->points[mesh->tris[t][(i + 1) % 3]]) > longest_m;
    size_t count = mesh->tri_count - sort_hidden(mesh, aside);
    mem_free(aside);
    return count;
}

/* Merges model vertices at short sides of needle-shaped triangles. They become strays. */
static void merge_short_sides(struct surface *surface)
{
    surface->plane = mem_array(surface->report.triangles, sizeof(*surface->plane));
    for (uint32_t source = 0; source < surface->report.triangles; source++)
        surface->plane[source] = source;
    short_sides_merge(&surface->mesh, surface->report.size_m, surface->report.tolerance_m, surface->plane);
}

/* Samples the surface evenly: adds points until edges are no longer than the spacing. Rods and narrow strips take more points
 * than their area suggests. If there are too many points, the spacing grows for all parts. A single unsampled part would keep
 * edges as long as the asset, and have poor distances. Triangles that reach from the main part to a stray vertex are not
 * sampled, because they would use up all points. */
static void sample(struct surface *surface)
{
    struct surface_report *report = &surface->report;
    struct trimesh *mesh = &surface->mesh, whole = { 0 };
    size_t before = mesh->point_count, limit = before + (size_t)(2 * SAMPLES), all = mesh->tri_count, needles = set_aside_needles(surface);
    trimesh_copy(&whole, mesh);
    mesh->tri_count = whole.tri_count = all - needles;
    if (report->spacing_m <= 0)
        report->spacing_m = sqrt(POINTS_PER_SPACING * trimesh_area(mesh) / SAMPLES);
    trimesh_sample(mesh, report->spacing_m, limit);
    while (mesh->point_count >= limit) {
        report->spacing_m *= SPACING_GROWTH;
        trimesh_copy(mesh, &whole);
        trimesh_sample(mesh, report->spacing_m, limit);
    }
    for (size_t t = all - needles; t < all; t++)
        trimesh_add_tri(mesh, whole.tris[t][0], whole.tris[t][1], whole.tris[t][2], whole.tri_source[t]);
    trimesh_finish(&whole);
    report->samples = mesh->point_count - before;
}

/* Lists the model vertices that belong to no triangle of the surface, and counts the vertices that only hidden triangles use. */
static void find_strays(struct surface *surface)
{
    char *used = mem_array(surface->mesh.point_count, 1);
    size_t capacity = 0;
    for (size_t t = 0; t < surface->mesh.tri_count; t++)
        for (int i = 0; i < 3; i++)
            used[surface->mesh.tris[t][i]] = 1;
    for (uint32_t v = 0; v < surface->vertex_count; v++) {
        uint32_t p = surface->vertex_point[v];
        struct bvh_place place;
        surface->report.hidden_vertices += used[p] && surface->propagation.hidden[p];
        if (used[p])
            continue;
        bvh_nearest(surface->bvh, surface->mesh.points[p], INFINITY, NULL, NULL, &place);
        mem_grow(&surface->strays, &capacity, surface->stray_count + 1, sizeof(*surface->strays));
        struct stray *stray = &surface->strays[surface->stray_count++];
        stray->vertex = v;
        stray->tri = place.tri;
        memcpy(stray->point_m, place.point, sizeof(stray->point_m));
    }
    mem_free(used);
}

/* Groups the visible triangles of the surface by model triangle (each is a piece of one). Model triangles that share pieces form one
 * group: coplanar ones, and neighbours of needles that were merged. */
static void list_pieces(struct surface *surface)
{
    const struct trimesh *mesh = &surface->visible;
    surface->piece_first = mem_array(surface->report.triangles + 2, sizeof(*surface->piece_first));
    surface->pieces = mem_array(mesh->tri_count, sizeof(*surface->pieces));
    for (size_t t = 0; t < mesh->tri_count; t++)
        surface->piece_first[surface->plane[mesh->tri_source[t]] + 2]++;
    for (size_t s = 2; s < surface->report.triangles + 2; s++)
        surface->piece_first[s] += surface->piece_first[s - 1];
    for (uint32_t t = 0; t < mesh->tri_count; t++)
        surface->pieces[surface->piece_first[surface->plane[mesh->tri_source[t]] + 1]++] = t;
}

static void index_some(void *arg, size_t begin, size_t end)
{
    struct surface *surface = arg;
    for (size_t i = begin; i < end; i++)
        if (i == 0) {
            if (!surface->intrinsic.points)
                intrinsic_init(&surface->intrinsic, &surface->visible);
            propagation_init(&surface->propagation, &surface->mesh, surface->visible.tri_count, &surface->intrinsic);
        } else if (i == 1) {
            surface->bvh = bvh_create(&surface->visible);
        } else {
            list_pieces(surface);
        }
}

void surface_index(struct surface *surface)
{
    if (surface->workers)
        workers_for(surface->workers, 3, 1, index_some, surface);
    else
        index_some(surface, 0, 3);
}

static double mean_edge(const struct intrinsic *in)
{
    double sum = 0;
    for (size_t t = 0; t < in->tri_count; t++)
        sum += in->lengths[t][0] + in->lengths[t][1] + in->lengths[t][2];
    return sum / (3.0 * (double)in->tri_count);
}

struct surface *surface_create(struct log *log, struct workers *workers, const float (*positions_m)[3], size_t vertex_count,
                               const uint32_t *triangles, size_t triangle_count, const struct surface_params *params)
{
    struct surface *surface = mem_new(sizeof(*surface));
    struct surface_report *report = &surface->report;
    struct body_parts parts;
    int64_t since_ns = clock_mono_ns();
    double size_m = gap_main_size(positions_m, triangles, triangle_count);
    surface->log = log;
    surface->workers = workers;
    surface->vertex_count = vertex_count;
    report->size_m = size_m;
    report->tolerance_m = params->tolerance_m > 0 ? params->tolerance_m : size_m * TOLERANCE_OF_SIZE;
    report->spacing_m = params->spacing_m;
    report->time_m2 = report->heat_disagreement = (double)NAN;
    if (!weld(surface, positions_m, triangles, triangle_count, size_m, params->why))
        goto error;
    report->weld_s = seconds_since(&since_ns);
    merge_short_sides(surface);
    if (!close_seams(surface, params->why))
        goto error;
    parts_init(&parts, &surface->mesh, triangle_count, report->tolerance_m, params->tolerance_m <= 0);
    parts.size_m = size_m;
    trimesh_stop_counting(&surface->mesh);
    report->border_edges_after = border_edges(&surface->mesh);
    report->bridge_s = seconds_since(&since_ns);
    sample(surface);
    report->sample_s = seconds_since(&since_ns);
    join_parts(surface, &parts);
    parts_finish(&parts);
    report->bridge_s += seconds_since(&since_ns);
    surface->component = mem_array(surface->mesh.point_count, sizeof(*surface->component));
    report->components_after = trimesh_components(&surface->visible, surface->component);
    surface_index(surface);
    find_strays(surface);
    surface->edge_m = mean_edge(&surface->intrinsic);
    report->laplacian_s = seconds_since(&since_ns);
    return surface;
error:
    surface_destroy(&surface);
    return NULL;
}

void surface_destroy(struct surface **surface_ptr)
{
    struct surface *surface = *surface_ptr;
    if (!surface)
        return;
    intrinsic_finish(&surface->intrinsic);
    propagation_finish(&surface->propagation);
    bvh_destroy(&surface->bvh);
    trimesh_finish(&surface->mesh);
    mem_free(surface->vertex_point);
    mem_free(surface->component);
    mem_free(surface->plane);
    mem_free(surface->strays);
    mem_free(surface->piece_first);
    mem_free(surface->pieces);
    mem_free(surface->bridges);
    mem_free(surface);
    *surface_ptr = NULL;
}

const struct surface_report *surface_report(const struct surface *surface)
{
    return &surface->report;
}

void surface_debug_mesh(const struct surface *surface, struct surface_debug_mesh *look)
{
    *look = (struct surface_debug_mesh){
        .points_m = (const double(*)[3])surface->mesh.points,
        .tris = (const uint32_t(*)[3])surface->mesh.tris,
        .point_count = surface->mesh.point_count,
        .tri_count = surface->mesh.tri_count,
        .visible_count = surface->visible.tri_count,
        .vertex_point = surface->vertex_point,
        .vertex_count = surface->vertex_count,
        .bridges = surface->bridges,
        .bridge_count = surface->bridge_count,
    };
}
