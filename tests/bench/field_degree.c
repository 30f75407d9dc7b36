/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An experiment: how many triangles and how many rows (places where the field is computed) it takes to show the field when it is linear
   over a triangle, as in the product, and when it is quadratic: an edge along which linear errs has a third value, at its middle.

   usage: field_degree MODEL NODES UP SENSORS [PIXEL_MM]

   The model's nodes get so many sensors at random places (seed 1), all of one group. One mesh is made for all of a client's choices: along
   the surface and straight, by shepard and, up to 64 sensors, by paper. Errors are the largest for any readings, in parts of the range,
   against the field at the place itself. Each row is printed as a line of JSON. */
#include <math.h>
#include <meshoptimizer.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/math/vec.h"
#include "base/mem.h"
#include "preprocess/geometry/welded_positions.h"
#include "preprocess/model/model_source.h"
#include "surface/mesh/bvh.h"
#include "tests/bench/cut_mesh.h"
#include "tests/support/cad.h"

#define FIRST_STAGE 32 /* times the limit: errors that are mended first */
#define NEXT_STAGE 1.4142135623730951
#define MOST_ROUNDS 12 /* of a stage: slivers beside slivers can be cut without end */
#define POINTS 10000
#define JUMP_WIDTH 8   /* tolerances: edges along which it jumps are not cut into shorter ones */
#define SHORTEST 0.125 /* tolerances: nor any */

static struct cad_random chance = { 1 };
static const char *const combo_names[CUT_CHOICES] = { "geodesic shepard", "geodesic paper", "straight shepard", "straight paper" };

/* --- what comes of it ----------------------------------------------------------------------------------------------------------- */

static void random_weights(double w[3])
{
    double a = sqrt(cad_random(&chance)), b = cad_random(&chance);
    w[0] = 1 - a;
    w[1] = a * (1 - b);
    w[2] = a * b;
}

struct counts {
    size_t triangles, corners, middles;
};

static struct counts count(const struct cut_mesh *mesh)
{
    struct counts counts = { 0 };
    char *used = mem_array(mesh->vertex_count, 1), *seen = mem_array(mesh->edge_count, 1);
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3 && !mesh->tris[t].gone; i++) {
            const struct tri *tri = &mesh->tris[t];
            counts.triangles += i == 0;
            counts.corners += !used[tri->v[i]];
            used[tri->v[i]] = 1;
            counts.middles += !seen[tri->e[i]] && mesh->edges[tri->e[i]].curved;
            seen[tri->e[i]] = 1;
        }
    mem_free(used);
    mem_free(seen);
    return counts;
}

/* All readings change: rows times sensors, as the field does it. Milliseconds, the best of five. */
static double update_ms(size_t rows, size_t sensors)
{
    float *g = mem_array(rows * sensors, sizeof(*g)), *v = mem_array(rows, sizeof(*v)), *change = mem_array(sensors, sizeof(*change));
    double best_ms = INFINITY;
    for (size_t i = 0; i < rows * sensors; i++)
        g[i] = 1e-3f;
    for (size_t s = 0; s < sensors; s++)
        change[s] = (float)s;
    for (int n = 0; n < 5; n++) {
        int64_t began_ns = clock_mono_ns();
        for (size_t s = 0; s < sensors; s++)
            for (size_t r = 0; r < rows; r++)
                v[r] += g[s * rows + r] * change[s];
        best_ms = min_of(best_ms, (double)(clock_mono_ns() - began_ns) / NS_PER_MS);
    }
    if (v[rows / 2] == 0)
        puts("");
    mem_free(g);
    mem_free(v);
    mem_free(change);
    return best_ms;
}

/* 10,000 places evenly over what is seen. bytes: as an asset file has it: for a corner place, normal and distances, for a middle distances,
   for a triangle three numbers, or six. */
static void print_row(struct cut_mesh *mesh, const char *what, double seconds, size_t evaluations)
{
    struct counts n = count(mesh);
    size_t rows = n.corners + n.middles, sensors = mesh->truth->sensors;
    double *upto = mem_array(mesh->tri_count + 1, sizeof(*upto)), worst[CUT_CHOICES] = { 0 };
    size_t over[CUT_CHOICES] = { 0 }, seen = 0;
    float *room = mem_array(mesh->truth->numbers + sensors, sizeof(*room));
    for (size_t t = 0; t < mesh->tri_count; t++) {
        double normal[3];
        const uint32_t *v = mesh->tris[t].v;
        vec_normal(mesh->vertices[v[0]].at, mesh->vertices[v[1]].at, mesh->vertices[v[2]].at, normal);
        upto[t + 1] = upto[t] + (mesh->tris[t].gone ? 0 : vec_length(normal));
    }
    chance.state = 7;
    for (int tries = 0; seen < POINTS && tries < 10 * POINTS; tries++) {
        double at = cad_random(&chance) * upto[mesh->tri_count], w[3];
        size_t low = 0, high = mesh->tri_count;
        while (high - low > 1) {
            size_t middle = (low + high) / 2;
            if (upto[middle] <= at)
                low = middle;
            else
                high = middle;
        }
        random_weights(w);
        if (cut_mesh_error(mesh, &mesh->tris[low], w, room, CUT_CHOICES, false) < 0)
            continue;
        seen++;
        for (int c = 0; c < CUT_CHOICES; c++) {
            double error = cut_mesh_error(mesh, &mesh->tris[low], w, room, c, true);
            worst[c] = max_of(worst[c], error);
            over[c] += error > SUBDIV_ERROR;
        }
    }
    size_t bytes = n.corners * (24 + 4 * sensors) + n.middles * 4 * sensors + n.triangles * (n.middles ? 24 : 12);
    printf("{\"what\": \"%s\", \"sensors\": %zu, \"triangles\": %zu, \"corners\": %zu, \"middles\": %zu, \"rows\": %zu, \"mb\": %.1f, "
           "\"seconds\": %.2f, \"evaluations\": %zu, \"update_ms\": %.2f",
           what, sensors, n.triangles, n.corners, n.middles, rows, (double)bytes / 1e6, seconds, evaluations, update_ms(rows, sensors));
    for (int c = 0; c < CUT_CHOICES; c++)
        if (c % 2 == 0 || mesh->truth->linear.groups[0].papers)
            printf(", \"%s\": {\"worst\": %.2f, \"over\": %zu}", combo_names[c], 255 * worst[c], over[c]);
    printf(", \"points\": %zu}\n", seen);
    fflush(stdout);
    mem_free(upto);
    mem_free(room);
}

/* --- the asset ------------------------------------------------------------------------------------------------------------------ */

struct asset {
    struct geometry g;
    struct plant plant;
    struct plant_sensor *sensors;
    struct asset_sensor *places;
    struct surface *surface;
    struct surface_field field;
    struct truth truth;
    double (*points)[3];
};

static void place_sensors(struct asset *asset, size_t count)
{
    const struct geometry *g = &asset->g;
    size_t tris = g->index_count / 3;
    double *upto = mem_array(tris + 1, sizeof(*upto));
    for (size_t t = 0; t < tris; t++) {
        double n[3];
        const uint32_t *v = g->indices + 3 * t;
        vecf_normal(g->positions_m[v[0]], g->positions_m[v[1]], g->positions_m[v[2]], n);
        upto[t + 1] = upto[t] + vec_length(n);
    }
    for (size_t s = 0; s < count; s++) {
        double w[3], at = cad_random(&chance) * upto[tris];
        size_t t = 0;
        while (t + 1 < tris && upto[t + 1] < at)
            t++;
        random_weights(w);
        for (int axis = 0; axis < 3; axis++) {
            asset->points[s][axis] = 0;
            for (int i = 0; i < 3; i++)
                asset->points[s][axis] += w[i] * (double)g->positions_m[g->indices[3 * t + (size_t)i]][axis];
        }
    }
    mem_free(upto);
}

static bool asset_init(struct asset *asset, const char *path, const char *nodes, enum axis up, size_t sensors, struct workers *workers)
{
    struct model_source source;
    struct gltf_model model;
    char why[MODEL_WHY_BYTES];
    const struct geometry_params params = { .nodes = *nodes ? nodes : NULL, .unit_m = 1, .up = up };
    *asset = (struct asset){ 0 };
    if (!model_source_open(&source, path, why) || !gltf_load(&model, &source, why) || !geometry_cut(&asset->g, &model, &params, why)) {
        fprintf(stderr, "%s: %s\n", path, why);
        return false;
    }
    gltf_free(&model);
    model_source_finish(&source);
    const struct geometry *g = &asset->g;
    asset->surface = surface_create(NULL, workers, (const float(*)[3])g->positions_m, g->vertex_count, g->indices, g->index_count / 3,
                                    &(struct surface_params){ 0 });
    asset->points = mem_array(sensors, sizeof(*asset->points));
    asset->sensors = mem_array(sensors, sizeof(*asset->sensors));
    asset->places = mem_array(sensors, sizeof(*asset->places));
    asset->plant.groups = mem_array(1, sizeof(*asset->plant.groups));
    asset->plant.groups[0] = (struct plant_group){ .max = 1, .power = 2, .reach_m = INFINITY };
    asset->plant.tags = mem_array(sensors, sizeof(*asset->plant.tags));
    asset->plant.group_count = 1;
    asset->plant.tag_count = sensors;
    place_sensors(asset, sensors);
    if (!asset->surface || !surface_field_init(&asset->field, asset->surface, (const double(*)[3])asset->points, sensors, NULL))
        return false;
    float(*places)[3] = mem_array(sensors, sizeof(*places));
    for (size_t s = 0; s < sensors; s++) {
        asset->plant.tags[s] = (struct plant_tag){ .strength = 1, .decay = 1 };
        asset->sensors[s].tag = (int)s;
        for (int axis = 0; axis < 3; axis++)
            places[s][axis] = asset->places[s].surface_m[axis] = (float)asset->field.sources[s].point_m[axis];
    }
    asset->truth = (struct truth){ .surface = asset->surface, .field = &asset->field, .sensors = sensors };
    linear_error_init(&asset->truth.linear, &asset->plant, asset->sensors, sensors, (const float(*)[3])places);
    asset->truth.numbers = linear_error_sample_count(&asset->truth.linear);
    asset->truth.limit_m = surface_report(asset->surface)->tolerance_m / 4;
    mem_free(places);
    return true;
}

/* What the solver found at a vertex of the model, wherever repairing put it. */
static void take_vertex(struct cut_mesh *mesh, const struct asset *asset, uint32_t vertex, uint32_t of_model)
{
    struct vertex *to = &mesh->vertices[vertex];
    struct interp_norm norms[8];
    if (!to->sample)
        return;
    surface_field_at_vertex(&asset->field, asset->surface, of_model, to->geodesic_m);
    linear_error_weights(&mesh->truth->linear, asset->g.positions_m[of_model], to->geodesic_m, false, to->sample, norms);
}

/* Vertices at one place are one. */
static void load(struct cut_mesh *mesh, struct asset *asset, const uint32_t *indices, size_t tris, const uint32_t *of_vertex, size_t places,
                 bool is_model)
{
    uint32_t *vertex_of = mem_array(places, sizeof(*vertex_of));
    memset(vertex_of, 0xff, places * sizeof(*vertex_of));
    edge_table_init(&mesh->table, tris * 2);
    for (size_t t = 0; t < tris; t++) {
        uint32_t v[3];
        struct facing facing = { .origin = is_model ? (uint32_t)t : NO_ORIGIN };
        const uint32_t *from = indices + 3 * t;
        vecf_normal(asset->g.positions_m[from[0]], asset->g.positions_m[from[1]], asset->g.positions_m[from[2]], facing.normal);
        vec_normalize(facing.normal);
        for (int i = 0; i < 3; i++) {
            const float *p = asset->g.positions_m[from[i]];
            uint32_t *vertex = &vertex_of[of_vertex[from[i]]];
            if (*vertex == NO_VERTEX) {
                *vertex = cut_mesh_add_vertex(mesh, (const double[3]){ (double)p[0], (double)p[1], (double)p[2] }, &facing);
                if (is_model)
                    take_vertex(mesh, asset, *vertex, from[i]);
            }
            v[i] = *vertex;
        }
        if (v[0] != v[1] && v[1] != v[2] && v[2] != v[0])
            cut_mesh_add_tri(mesh, v[0], v[1], v[2], facing.origin);
    }
    mem_free(vertex_of);
}

/* A corner where each sensor stands: the triangle below it becomes three. */
static void stand(struct cut_mesh *mesh, const struct asset *asset)
{
    for (size_t s = 0; s < mesh->truth->sensors; s++) {
        const double *at = asset->field.sources[s].point_m;
        double best_m = INFINITY, w[3];
        size_t best = 0;
        for (size_t t = 0; t < mesh->tri_count; t++) {
            const struct tri *tri = &mesh->tris[t];
            const double *p[3] = { mesh->vertices[tri->v[0]].at, mesh->vertices[tri->v[1]].at, mesh->vertices[tri->v[2]].at };
            double place[3];
            if (tri->gone || triangle_is_farther(at, p[0], p[1], p[2], best_m))
                continue;
            triangle_nearest(at, p[0], p[1], p[2], w);
            for (int axis = 0; axis < 3; axis++)
                place[axis] = w[0] * p[0][axis] + w[1] * p[1][axis] + w[2] * p[2][axis];
            if (vec_distance(place, at) < best_m) {
                best_m = vec_distance(place, at);
                best = t;
            }
        }
        const struct tri tri = mesh->tris[best];
        const struct facing facing = cut_mesh_facing(mesh, &tri);
        uint32_t v = cut_mesh_add_vertex(mesh, at, &facing);
        mesh->tris[best].gone = true;
        mesh->live--;
        for (int i = 0; i < 3; i++)
            cut_mesh_add_tri(mesh, tri.v[i], tri.v[(i + 1) % 3], v, tri.origin);
    }
}

static void set_radius(struct asset *asset)
{
    size_t sensors = asset->truth.sensors, padded = interp_padded(sensors);
    float *row = mem_array(sensors, sizeof(*row)), *most[2] = { mem_array(padded, sizeof(float)), mem_array(padded, sizeof(float)) };
    for (uint32_t v = 0; v < asset->g.vertex_count; v++) {
        surface_field_at_vertex(&asset->field, asset->surface, v, row);
        for (size_t s = 0; s < sensors; s++) {
            const float *p = asset->g.positions_m[v], *q = asset->places[s].surface_m;
            float straight = sqrtf((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]));
            most[0][s] = isfinite(row[s]) && row[s] > most[0][s] ? row[s] : most[0][s];
            most[1][s] = straight > most[1][s] ? straight : most[1][s];
        }
    }
    linear_error_set_radius(&asset->truth.linear, (const float *const *)most);
    mem_free(row);
    mem_free(most[0]);
    mem_free(most[1]);
}

static void cut(struct asset *asset, const char *what, const uint32_t *indices, size_t tris, const uint32_t *of_vertex, size_t places,
                bool quadratic, bool by_rows, double shortest_m)
{
    struct cut_mesh mesh = { .truth = &asset->truth, .quadratic = quadratic, .limit = CUT_AIM };
    float *room = mem_array(asset->truth.numbers + asset->truth.sensors, sizeof(*room));
    int64_t began_ns = clock_mono_ns();
    mesh.shortest_m = shortest_m;
    mesh.jump_m = max_of(shortest_m, JUMP_WIDTH * surface_report(asset->surface)->tolerance_m);
    size_t model = asset->g.index_count / 3, most = model + (2 * model > 100000 ? 2 * model : 100000);
    asset->truth.evaluations = 0;
    load(&mesh, asset, indices, tris, of_vertex, places, indices == asset->g.indices);
    stand(&mesh, asset);
    bool is_full = false;
    for (mesh.stage = FIRST_STAGE * mesh.limit; mesh.stage > 0.99 * mesh.limit && !is_full; mesh.stage /= NEXT_STAGE)
        for (int round = 0; round < MOST_ROUNDS && !is_full && cut_mesh_round(&mesh, room); round++) {
            struct counts n = count(&mesh);
            is_full = by_rows ? n.corners + n.middles >= places + (most - model) / 2 : n.triangles >= most;
        }
    print_row(&mesh, what, (double)(clock_mono_ns() - began_ns) / NS_PER_S, asset->truth.evaluations);
    cut_mesh_finish(&mesh);
    mem_free(room);
}

/* The level that is drawn where a pixel is so large: the coarsest that errs by no more. */
static const struct level *level_for(const struct levels *levels, double pixel_m)
{
    const struct level *found = &levels->at[0];
    for (size_t l = 1; l < levels->count; l++)
        if ((double)levels->at[l].error_m <= pixel_m)
            found = &levels->at[l];
    return found;
}

/* A hierarchy of clusters cannot take fewer triangles for an error than simplifying the whole to just that error does: its clusters keep
   their borders. */
static size_t simplified(const struct geometry *g, const uint32_t *of_vertex, size_t places, const float (*positions_m)[3], double pixel_m)
{
    uint32_t *indices = mem_array(g->index_count, sizeof(*indices));
    for (uint32_t i = 0; i < g->index_count; i++)
        indices[i] = of_vertex[g->indices[i]];
    float scale_m = meshopt_simplifyScale(positions_m[0], places, sizeof(*positions_m));
    size_t left = meshopt_simplify(indices, indices, g->index_count, positions_m[0], places, sizeof(*positions_m), 0,
                                   (float)pixel_m / scale_m, 0, NULL);
    mem_free(indices);
    return left / 3;
}

static void measure_product(struct asset *asset, struct levels *levels, double pixel_m, struct workers *workers)
{
    struct distance_rows rows;
    struct welded_positions welded;
    int64_t began_ns = clock_mono_ns();
    if (!subdivide_levels(levels, &asset->g,
                          &(struct subdiv_input){ .linear = &asset->truth.linear,
                                                  .surface = asset->surface,
                                                  .field = &asset->field,
                                                  .sensors = asset->places,
                                                  .workers = workers },
                          &rows))
        abort();
    double seconds = (double)(clock_mono_ns() - began_ns) / NS_PER_S;
    struct cut_mesh mesh = { .truth = &asset->truth, .limit = CUT_AIM };
    const struct level *level = &levels->at[0], *far = level_for(levels, pixel_m);
    if (!welded_init(&welded, (const float(*)[3])asset->g.positions_m, asset->g.vertex_count))
        abort();
    load(&mesh, asset, level->indices, level->index_count / 3, welded.of_vertex, welded.count, false);
    print_row(&mesh, "product, all levels in its seconds", seconds, 0);
    printf("{\"what\": \"product's level at a pixel\", \"sensors\": %zu, \"error_mm\": %.1f, \"simplified\": %u, \"triangles\": %u}\n",
           asset->truth.sensors, 1e3 * (double)far->error_m, far->whole_count / 3, far->index_count / 3);
    cut_mesh_finish(&mesh);
    mesh = (struct cut_mesh){ .truth = &asset->truth };
    asset->truth.limit_m = max_of(asset->truth.limit_m, 1.5 * (double)far->error_m);
    load(&mesh, asset, far->indices, far->index_count / 3, welded.of_vertex, welded.count, false);
    print_row(&mesh, "product, at a pixel", 0, 0);
    cut_mesh_finish(&mesh);
    distance_rows_finish(&rows);
}

int main(int argc, char **argv)
{
    struct asset asset;
    struct levels levels;
    struct welded_positions welded;
    size_t sensors = argc > 4 ? strtoul(argv[4], NULL, 10) : 0;
    double pixel_m = argc > 5 ? strtod(argv[5], NULL) / 1e3 : 0.022;
    struct workers *workers = workers_create(0);
    if (sensors == 0 || !asset_init(&asset, argv[1], argv[2], *argv[3] == 'y' ? AXIS_Y : AXIS_Z, sensors, workers) ||
        !levels_make(&levels, &asset.g, workers)) {
        fputs("usage: field_degree MODEL NODES UP SENSORS [PIXEL_MM]\n", stderr);
        return 2;
    }
    set_radius(&asset);
    if (!welded_init(&welded, (const float(*)[3])asset.g.positions_m, asset.g.vertex_count))
        abort();
    const struct level *far = level_for(&levels, pixel_m);
    printf("{\"what\": \"model\", \"triangles\": %u, \"places\": %zu, \"direct at a pixel\": %zu}\n", asset.g.index_count / 3, welded.count,
           simplified(&asset.g, welded.of_vertex, welded.count, (const float(*)[3])welded.positions_m, pixel_m));
    cut(&asset, "linear", asset.g.indices, asset.g.index_count / 3, welded.of_vertex, welded.count, false, false,
        SHORTEST * surface_report(asset.surface)->tolerance_m);
    cut(&asset, "quadratic", asset.g.indices, asset.g.index_count / 3, welded.of_vertex, welded.count, true, false,
        SHORTEST * surface_report(asset.surface)->tolerance_m);
    cut(&asset, "quadratic, as many rows", asset.g.indices, asset.g.index_count / 3, welded.of_vertex, welded.count, true, true,
        SHORTEST * surface_report(asset.surface)->tolerance_m);
    asset.truth.limit_m = max_of(asset.truth.limit_m, 1.5 * (double)far->error_m);
    for (int quadratic = 0; quadratic < 2; quadratic++)
        cut(&asset, quadratic ? "quadratic, at a pixel" : "linear, at a pixel", far->indices, far->index_count / 3, welded.of_vertex,
            welded.count, quadratic, false, pixel_m);
    asset.truth.limit_m = surface_report(asset.surface)->tolerance_m / 4;
    measure_product(&asset, &levels, pixel_m, workers);
    return 0;
}
