/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the edges along which the field is not straight, and cuts them where that helps most, until it is: those that err most first. */
#include "preprocess/split.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/vec.h"
#include "preprocess/split_impl.h"

#define MOST_ROUNDS 16
#define GRAIN 2048       /* triangles: a few tenths of a millisecond */
#define MOST_KEPT 512    /* shares of a place */
#define LARGE 0.25       /* of the way to the nearest sensor */
#define LIKELY 1.0       /* errors of the edges together, in limits: with less, one of 500 large triangles errs more inside */
#define INSIDE_LEAST 2.0 /* shortest pieces: smaller triangles are not looked at inside */
#define FLAT 1e-3        /* a triangle's longest edge is no more than that shorter than the way round over the corner across */
#define ASIDE 0.1        /* of the edge, at least, that corner is from its ends */
#define LINE_OF_SIZE 2.5e-7 /* a triangle no higher than that, a few units of the last place, is a line */
#define MORE_PLACES 12.0 /* room for places, in those that the model has */
#define MOST_ASKED 2000  /* short edges of a coarser level that are looked at for what is told of it */
#define FULL 2e-4        /* a level that may grow by less than that is done: each round takes half of what is left */

/* How many triangles the finest level may get more: so much of its own, or so many, whichever is more. */
#define FINEST_GROWTH 2.0
#define FINEST_GROWTH_TRIS 100000.0
#define WORTH 0.85          /* a coarser level that would get more than so much of the next finer one is of no use */
#define SAMPLE_WORTH 9000   /* levels of so many triangles or more are first tried on a sample: those of fewer hang on too few of them */
#define SAMPLE_ROUNDS 4     /* of cuts, then it is known or never will be */
#define SHORTEST_NEAR 0.125 /* pieces of the finest level, of the tolerance: sensors may stand side by side */
#define SHORTEST 1.0        /* pieces of coarser levels, of their error: two pixels */
#define JUMP_WIDTH 8        /* tolerances, or errors */
#define ON_SURFACE 0.25     /* tolerances: so far apart places may be said to be the same */
#define SLACK 0.7           /* how far away a coarser level may show what the field is, likewise */

/* --- cutting -------------------------------------------------------------------------------------------------------------- */

#define BINS (1u << 16)
static uint32_t bin_of(float error) /* errors are not negative: their bits have their order */
{
    uint32_t bits;
    memcpy(&bits, &error, sizeof(bits));
    return bits >> 16;
}

/* Keeps the `most` worst ones, in the order that they have; of about the last error, the first ones. Returns how many that are. */
static size_t keep_worst(struct split_finding *findings, size_t count, size_t most)
{
    if (count <= most)
        return count;
    size_t *bins = mem_array(BINS, sizeof(*bins)), above = 0, kept = 0;
    uint32_t last = BINS - 1;
    for (size_t i = 0; i < count; i++)
        bins[bin_of(findings[i].error)]++;
    for (; last > 0 && above + bins[last] <= most; last--)
        above += bins[last];
    for (size_t i = 0; i < count; i++) {
        uint32_t bin = bin_of(findings[i].error);
        above += bin == last;
        if (bin > last || (bin == last && above <= most))
            findings[kept++] = findings[i];
    }
    mem_free(bins);
    return kept;
}

/* It has no width that a picture could show. */
static bool is_line(const struct split *split, const struct cut_tri *tri)
{
    double p[3][3], normal[3], longest_m = 0;
    for (int c = 0; c < 3; c++)
        for (int axis = 0; axis < 3; axis++)
            p[c][axis] = (double)split_position(split, tri->v[c])[axis];
    for (int c = 0; c < 3; c++)
        longest_m = max_of(longest_m, vec_distance(p[c], p[(c + 1) % 3]));
    vec_normal(p[0], p[1], p[2], normal);
    return vec_length(normal) <= LINE_OF_SIZE * split->size_m * longest_m;
}

void split_measure_new_edges(struct split *split, struct split_finding *findings, size_t count)
{
    split_measure_edges(split, findings, count, SPLIT_AIM);
    for (size_t i = 0; i < count; i++) {
        struct cut_edge *edge = &split->mesh.cuts[findings[i].number];
        edge->error = findings[i].error;
        edge->barred = findings[i].barred;
        edge->jumps = findings[i].jumps;
        edge->unasked = false;
        edge->proven = findings[i].error <= (float)SPLIT_AIM && findings[i].barred <= (float)SPLIT_AIM;
        if (edge->middle == TRIMESH_NONE)
            edge->share = findings[i].share;
    }
}

/* In a coarser level: it stays as it is, whatever it errs by. */
static bool is_too_short(const struct split *split, const struct cut_edge *edge)
{
    return !split->finest && split_is_short(split, split_length(split_position(split, edge->a), split_position(split, edge->b)));
}

/* Measures edges that are new. One that only lines have is not seen; were it cut, they would become ever more. Half of the edges of coarser
   levels are too short to be cut: what they err by does not matter. */
static void measure_edges(struct split *split)
{
    struct cutmesh *mesh = &split->mesh;
    size_t count = 0;
    cutmesh_sort(&mesh->made);
    struct split_finding *findings = mem_array(3 * mesh->made.count, sizeof(*findings));
    for (size_t m = 0; m < mesh->made.count; m++) {
        const struct cut_tri *tri = &mesh->tris[mesh->made.at[m]];
        bool any_new = mesh->cuts[tri->e[0]].error < 0 || mesh->cuts[tri->e[1]].error < 0 || mesh->cuts[tri->e[2]].error < 0;
        bool asks = any_new && !is_line(split, tri);
        for (int i = 0; i < 3 && asks; i++) {
            struct cut_edge *edge = &mesh->cuts[tri->e[i]];
            if (edge->error >= 0)
                continue;
            edge->error = edge->barred = 0;
            edge->unasked = is_too_short(split, edge);
            if (!edge->unasked)
                findings[count++].number = tri->e[i];
        }
    }
    for (size_t m = 0; m < mesh->made.count; m++)
        for (int i = 0; i < 3; i++) {
            struct cut_edge *edge = &mesh->cuts[mesh->tris[mesh->made.at[m]].e[i]];
            if (edge->error < 0)
                edge->error = edge->barred = 0;
        }
    split_measure_new_edges(split, findings, count);
    mem_free(findings);
}

static int longest_edge(const struct split *split, const struct cut_tri *tri)
{
    int longest = 0;
    double most = 0;
    for (int i = 0; i < 3; i++) {
        double l = split_length(split_position(split, tri->v[i]), split_position(split, tri->v[(i + 1) % 3]));
        if (l > most) {
            most = l;
            longest = i;
        }
    }
    return longest;
}

/* Where a field bends evenly, it errs at the middle by 4/9 of what it errs along the three edges together. In a triangle that is large
   beside the way to the nearest sensor, anything may happen: but before the last limit the few are left for later that err by more than the
   limit though their edges do not. */
static bool inside_may_err(const struct split *split, const struct cut_tri *tri, double limit)
{
    const struct cutmesh *mesh = &split->mesh;
    double sum = 0;
    int i = longest_edge(split, tri);
    const float *a = split_position(split, tri->v[i]), *b = split_position(split, tri->v[(i + 1) % 3]);
    double length_m = split_length(a, b);
    for (int e = 0; e < 3; e++)
        sum += (double)mesh->cuts[tri->e[e]].error;
    if (length_m <= INSIDE_LEAST * split->shortest_m)
        return false;
    bool any_error = sum > LIKELY * limit || limit <= SPLIT_AIM;
    const struct shares_norm *norms = split->norms + mesh->places.of_vertex[tri->v[i]] * split->norm_count;
    return sum > 9 / 4.0 * limit || (any_error && length_m > LARGE * straight_nearest_of(split->in->straight, norms));
}

struct insides {
    const struct split *split;
    double limit;
    char *asked; /* of the triangles made */
};

static void choose_insides(void *arg, size_t begin, size_t end)
{
    const struct insides *insides = arg;
    const struct cutmesh *mesh = &insides->split->mesh;
    for (size_t m = begin; m < end; m++) {
        const struct cut_tri *tri = &mesh->tris[mesh->made.at[m]];
        double most = 0;
        for (int i = 0; i < 3; i++)
            most = max_of(most, (double)mesh->cuts[tri->e[i]].error);
        insides->asked[m] = !tri->good && most <= insides->limit && inside_may_err(insides->split, tri, insides->limit);
    }
}

/* Measures new triangles whose edges are good: has those that err inside cut at the longest edge. */
static void measure_insides(struct split *split, double limit)
{
    struct cutmesh *mesh = &split->mesh;
    size_t count = 0;
    cutmesh_sort(&mesh->made);
    struct insides insides = { split, limit, mem_array(mesh->made.count, 1) };
    split_for_all(split, mesh->made.count, GRAIN, choose_insides, &insides);
    for (size_t m = 0; m < mesh->made.count; m++)
        count += insides.asked[m] != 0;
    struct split_finding *findings = mem_array(count, sizeof(*findings));
    count = 0;
    for (size_t m = 0; m < mesh->made.count; m++)
        if (insides.asked[m]) {
            mesh->tris[mesh->made.at[m]].good = true;
            findings[count++].number = mesh->made.at[m];
        }
    mem_free(insides.asked);
    split_measure_insides(split, findings, count);
    for (size_t i = 0; i < count; i++)
        if ((double)findings[i].error > SPLIT_AIM) {
            const struct cut_tri *tri = &mesh->tris[findings[i].number];
            struct cut_edge *edge = &mesh->cuts[tri->e[longest_edge(split, tri)]];
            edge->error = fmaxf(edge->error, findings[i].error);
            edge->proven = false;
        }
    mem_free(findings);
}

static void cut_edges(struct split *split, const struct split_finding *findings, size_t count)
{
    struct cutmesh *mesh = &split->mesh;
    uint32_t *edges = mem_array(count, sizeof(*edges)), first = (uint32_t)mesh->places.count;
    size_t new_count = 0;
    for (size_t i = 0; i < count; i++) {
        uint32_t e = findings[i].number;
        float point[3];
        if (cutmesh_is_cut(mesh, e))
            continue;
        split_mix(split_position(split, mesh->cuts[e].a), split_position(split, mesh->cuts[e].b), (double)mesh->cuts[e].share, point);
        if (!cutmesh_cut(mesh, e, point))
            continue;
        split_add_place(split, mesh->cuts[e].middle, split->part[mesh->places.of_vertex[mesh->cuts[e].a]]);
        edges[new_count++] = e;
    }
    split_measure_places(split, first, edges, new_count);
    mem_free(edges);
}

/* In a flat triangle the longest edge runs beside the corner across: where it is to be cut, it is cut there. True: so it should be. */
static bool aim_at_corner(struct split *split, const struct cut_tri *tri, uint32_t *edge)
{
    const struct cutmesh *mesh = &split->mesh;
    int i = longest_edge(split, tri);
    uint32_t v[3] = { tri->v[i], tri->v[(i + 1) % 3], tri->v[(i + 2) % 3] };
    double ab = split_length(split_position(split, v[0]), split_position(split, v[1])),
           ca = split_length(split_position(split, v[2]), split_position(split, v[0])),
           cb = split_length(split_position(split, v[2]), split_position(split, v[1]));
    struct cut_edge *at = &mesh->cuts[tri->e[i]];
    *edge = tri->e[i];
    if (min_of(ca, cb) < max_of(split->shortest_m, ASIDE * ab) || ca + cb > ab * (1 + FLAT))
        return false;
    if (at->middle == TRIMESH_NONE)
        at->share = (float)((mesh->places.of_vertex[v[0]] == mesh->places.of_vertex[at->a] ? ca : cb) / (ca + cb));
    return true;
}

/* Edges beside corners at which other edges are cut, or the pieces would stay as long as they are. */
static void cut_beside_corners(struct split *split)
{
    struct cutmesh *mesh = &split->mesh;
    size_t count = 0;
    cutmesh_sort(&mesh->open);
    struct split_finding *findings = mem_array(mesh->open.count, sizeof(*findings));
    for (size_t m = 0; m < mesh->open.count; m++) {
        const struct cut_tri *tri = &mesh->tris[mesh->open.at[m]];
        bool others_cut = cutmesh_is_cut(mesh, tri->e[0]) || cutmesh_is_cut(mesh, tri->e[1]) || cutmesh_is_cut(mesh, tri->e[2]);
        if (others_cut && !is_line(split, tri) && aim_at_corner(split, tri, &findings[count].number) &&
            !cutmesh_is_cut(mesh, findings[count].number))
            count++;
    }
    cut_edges(split, findings, count);
    mem_free(findings);
}

/* Edges that err too much, each as often as triangles have it, in the order of these. */
static struct split_finding *list_errors(const struct split *split, double limit, size_t *count)
{
    const struct cutmesh *mesh = &split->mesh;
    struct cut_list corners = { 0 };
    for (size_t m = 0; m < mesh->made.count; m++)
        for (int i = 0; i < 3; i++) {
            const struct cut_edge *edge = &mesh->cuts[mesh->tris[mesh->made.at[m]].e[i]];
            for (uint32_t corner = edge->corner; corner != TRIMESH_NONE && (double)edge->error > limit; corner = mesh->next[corner])
                cutmesh_list(&corners, corner);
        }
    cutmesh_sort(&corners);
    struct split_finding *findings = mem_array(corners.count, sizeof(*findings));
    for (*count = 0; *count < corners.count; ++*count) {
        uint32_t e = mesh->tris[corners.at[*count] / 3].e[corners.at[*count] % 3];
        findings[*count] = (struct split_finding){ .number = e, .error = mesh->cuts[e].error };
    }
    mem_free(corners.at);
    return findings;
}

/* Cuts the edges that err too much, the worst ones first, as long as the level may grow. False: nothing to do. */
static bool cut_worst(struct split *split, double limit)
{
    struct cutmesh *mesh = &split->mesh;
    size_t listed, room = split->most_tris > mesh->tri_count ? (split->most_tris - mesh->tri_count) / 2 : 0;
    cutmesh_sort(&mesh->made);
    struct split_finding *findings = list_errors(split, limit, &listed);
    for (size_t m = 0; m < mesh->made.count; m++) {
        struct cut_tri *tri = &mesh->tris[mesh->made.at[m]];
        if (!tri->aimed)
            aim_at_corner(split, tri, &(uint32_t){ 0 });
        tri->aimed = true;
    }
    split->full = (double)room < FULL * (double)mesh->tri_count;
    size_t count = keep_worst(findings, listed, room);
    cut_edges(split, findings, count);
    cut_beside_corners(split);
    mem_free(findings);
    mesh->made.count = 0;
    bool any = count > 0 && cutmesh_apply(mesh) > 0 && !split->full;
    if (count < listed)
        cutmesh_list_all(mesh);
    return any;
}

/* --- all ------------------------------------------------------------------------------------------------------------------ */

static void note_left(struct level *level, enum level_limit limit, float error, uint32_t edges)
{
    if ((double)error <= SPLIT_ERROR)
        return;
    level->left[limit].edges += edges;
    level->left[limit].steps = fmaxf(level->left[limit].steps, error / (float)SPLIT_ERROR);
}

/* Of those that were too short to be asked for, some; the rest errs as they do. Returns how many each of these stands for. */
static uint32_t ask_some(struct split *split)
{
    struct cutmesh *mesh = &split->mesh;
    struct split_finding *findings = mem_array(mesh->edges.count, sizeof(*findings));
    size_t count = 0, asked = 0;
    for (uint32_t e = 0; e < mesh->edges.count; e++)
        if (mesh->cuts[e].unasked && mesh->cuts[e].corner != TRIMESH_NONE)
            findings[count++].number = e;
    const size_t of = 1 + count / MOST_ASKED;
    for (size_t i = 0; i < count; i += of)
        findings[asked++].number = findings[i].number;
    split_measure_new_edges(split, findings, asked);
    for (size_t i = 0; i < asked; i++)
        mesh->cuts[findings[i].number].unasked = true;
    mem_free(findings);
    return (uint32_t)of;
}

static void tell_left(struct split *split, struct level *level)
{
    const struct cutmesh *mesh = &split->mesh;
    const uint32_t of = ask_some(split);
    char *told = mem_array(mesh->edges.count, 1);
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            const struct cut_edge *edge = &mesh->cuts[mesh->tris[t].e[i]];
            if (told[edge - mesh->cuts])
                continue;
            told[edge - mesh->cuts] = 1;
            note_left(level, LEVEL_LIMIT_TRIANGLES, edge->error, 1);
            note_left(level, edge->jumps ? LEVEL_LIMIT_JUMP : LEVEL_LIMIT_LENGTH, edge->barred, edge->unasked ? of : 1);
        }
    mem_free(told);
}

/* Until no edge errs by more than the limit. */
static void cut_to(struct split *split, double limit)
{
    int rounds = split->sample_blocks ? SAMPLE_ROUNDS : MOST_ROUNDS;
    for (int round = 0; round < rounds; round++) {
        if (round == 0)
            cutmesh_list_all(&split->mesh);
        measure_edges(split);
        if (!split->finest)
            split_turn_edges(split, limit);
        split->full = split_comes_to_bound(split);
        if (split->full)
            break;
        measure_insides(split, limit);
        if (!cut_worst(split, limit))
            break;
    }
}

/* What becomes of a sample when large errors are cut says that the level is no use: most of the work for such levels is saved. */
static bool is_hopeless(struct split *split, const struct level *level, double large)
{
    struct level sample;
    if (level->index_count / 3 < SAMPLE_WORTH)
        return false;
    split->sample_blocks = split_take_sample(&sample, level);
    split->full = false;
    if (split->sample_blocks > 1) {
        split->sample_of = (double)level->index_count / (double)sample.index_count;
        cutmesh_load(&split->mesh, &sample);
        split_place_sensors(split, split->error_m);
        cut_to(split, large);
    }
    split->sample_blocks = 0;
    level_finish(&sample);
    return split->full;
}

static bool is_known_hopeless(const struct split *split)
{
    return split->in->kept && split->in->kept->hopeless >> split->level & 1;
}

/* Large errors go first: should the level come to its bound, the smaller ones are what is left. */
static void split_level(struct split *split, struct level *level, size_t finer_tris)
{
    static const double limits[] = { 16 * SPLIT_AIM, 4 * SPLIT_AIM, 2 * SPLIT_AIM, SPLIT_AIM };
    double error_m = (double)level->error_m, tolerance_m = surface_report(split->in->surface)->tolerance_m;
    split->finest = finer_tris == 0;
    split->error_m = error_m;
    split->on_surface_m = split->finest ? ON_SURFACE * tolerance_m : max_of(ON_SURFACE * tolerance_m, 1.5 * error_m);
    split->slack_m = SLACK * error_m;
    split->shortest_m = split->finest ? SHORTEST_NEAR * tolerance_m : max_of(tolerance_m, SHORTEST * error_m);
    split->jump_m = JUMP_WIDTH * max_of(tolerance_m, SHORTEST * error_m);
    double tris = (double)(level->index_count / 3);
    split->most_tris = (size_t)(split->finest ? tris + max_of(FINEST_GROWTH * tris, FINEST_GROWTH_TRIS) : WORTH * (double)finer_tris);
    split->full = !split->finest && (is_known_hopeless(split) || is_hopeless(split, level, limits[0]));
    if (split->full)
        return;
    cutmesh_load(&split->mesh, level);
    split_place_sensors(split, error_m);
    split->full = split->mesh.tri_count >= split->most_tris;
    for (size_t l = 0; l < sizeof(limits) / sizeof(*limits) && !split->full; l++)
        cut_to(split, limits[l]);
    if (split->full && !split->finest)
        return;
    measure_edges(split);
    tell_left(split, level);
    cutmesh_store(&split->mesh, level);
}

/* A coarser level that came to its bound is given up: the next finer one is no dearer. */
static void split_all(struct split *split, struct levels *levels)
{
    size_t kept = 0, finer_tris = 0;
    for (size_t l = 0; l < levels->count; l++) {
        struct level *level = &levels->at[l];
        split->level = (uint32_t)l;
        split_level(split, level, finer_tris);
        if (finer_tris > 0 && split->full) {
            if (split->in->kept)
                split->in->kept->given_up |= 1ull << l;
            level_finish(level);
            continue;
        }
        finer_tris = split->mesh.tri_count;
        levels->at[kept++] = *level;
        if (split->in->level_done)
            split->in->level_done(split->in->arg, &levels->at[kept - 1]);
    }
    levels->given_up = levels->count - kept;
    levels->count = kept;
}

static void set_radii(struct split *split)
{
    const struct places *places = &split->mesh.places;
    size_t padded = shares_padded(split->sensors);
    float *largest_m[2] = { mem_array(padded, sizeof(float)), mem_array(padded, sizeof(float)) };
    float *straight_m = mem_array(padded, sizeof(*straight_m));
    for (size_t p = 0; p < places->count; p++) {
        const float *geodesic_m = split->geodesic_m + p * split->sensors;
        shares_euclidean(places->positions_m[p], (const float *const *)split->in->straight->axes_m, padded, straight_m);
        for (size_t s = 0; s < split->sensors; s++) {
            float geodesic = geodesic_m[s] < INFINITY ? geodesic_m[s] : 0;
            largest_m[DISTANCE_GEODESIC][s] = geodesic > largest_m[DISTANCE_GEODESIC][s] ? geodesic : largest_m[DISTANCE_GEODESIC][s];
            largest_m[DISTANCE_EUCLIDEAN][s] =
                straight_m[s] > largest_m[DISTANCE_EUCLIDEAN][s] ? straight_m[s] : largest_m[DISTANCE_EUCLIDEAN][s];
        }
    }
    straight_set_radius(split->in->straight, (const float *const *)largest_m);
    mem_free(straight_m);
    mem_free(largest_m[0]);
    mem_free(largest_m[1]);
}

static bool start(struct split *split, struct geometry *geometry)
{
    float low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
    split->model = geometry->indices;
    if (!cutmesh_init(&split->mesh, geometry) || !split_find_parts(split))
        return false;
    size_t places = split->mesh.places.count;
    split->geodesic_capacity = (size_t)(MORE_PLACES * (double)places) * split->sensors; /* memory is taken as it is used */
    split->geodesic_m = mem_try_array(split->geodesic_capacity, sizeof(*split->geodesic_m));
    if (split->samples <= MOST_KEPT) {
        split->share_capacity = places * split->samples;
        split->shares = mem_try_array(split->share_capacity, sizeof(*split->shares));
    }
    split->norm_capacity = places * split->norm_count;
    split->norms = mem_array(split->norm_capacity, sizeof(*split->norms));
    if (!split->geodesic_m || (split->samples <= MOST_KEPT && !split->shares))
        return false;
    for (uint32_t v = 0; v < geometry->vertex_count; v++)
        surface_field_at_vertex(split->in->field, split->in->surface, v,
                                split->geodesic_m + split->mesh.places.of_vertex[v] * split->sensors);
    for (uint32_t v = 0; v < geometry->vertex_count; v++)
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = fminf(low[axis], geometry->positions_m[v][axis]);
            high[axis] = fmaxf(high[axis], geometry->positions_m[v][axis]);
        }
    split->size_m = split_length(low, high);
    set_radii(split);
    split_measure_places(split, 0, NULL, places);
    return true;
}

/* Taken out of what is then done with. */
static void take_rows(struct split *split, struct rows *rows)
{
    *rows = (struct rows){ .distances_m = split->geodesic_m,
                           .place_of = split->mesh.places.of_vertex,
                           .sensor_count = split->sensors,
                           .vertex_count = split->mesh.geometry->vertex_count };
    split->geodesic_m = NULL;
    split->mesh.places.of_vertex = NULL;
}

bool split_levels(struct levels *levels, struct geometry *geometry, const struct split_input *input, struct rows *distances)
{
    struct split split = { .in = input,
                           .sensors = input->straight->sensor_count,
                           .samples = straight_sample_count(input->straight),
                           .norm_count = 2 * input->straight->group_count };
    bool good = start(&split, geometry);
    *distances = (struct rows){ 0 };
    if (good) {
        split_all(&split, levels);
        take_rows(&split, distances);
    }
    cutmesh_finish(&split.mesh);
    mem_free(split.geodesic_m);
    mem_free(split.shares);
    mem_free(split.norms);
    mem_free(split.part);
    mem_free(split.faces);
    return good;
}
