/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds edges along which the values interpolated between sensors are not linear, and splits them, largest error first, until
   the errors are small enough. */
#include "preprocess/subdivision/subdivide.h"

#include <math.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "preprocess/subdivision/subdivide_impl.h"

#define MAX_ROUNDS 16
#define GRAIN 2048 /* number of triangles that a thread processes per unit of work, which takes a few tenths of a millisecond */
/* A sample is the list of the sensors' interpolation weights at one point (linear_error.h). Samples of up to this many numbers
 * are kept in memory for all vertex positions; longer samples are computed each time they are needed. */
#define MAX_STORED 512
/* length of a triangle's longest edge, as a share of the distance to the nearest sensor, above which the triangle counts as
   large */
#define LARGE 0.25
/* Sum of a triangle's edge errors, in multiples of the error limit, below which a large triangle is not measured inside: only
   one in 500 such triangles has an error inside above the limit. The last pass over a level measures it anyway. */
#define LIKELY 1.0
/* length of a triangle's longest edge, in multiples of the minimum edge length shortest_m, up to which the triangle is not
   measured inside */
#define MIN_INSIDE 2.0
#define FLAT 1e-3 /* a triangle is flat if the sum of its two shorter edges exceeds its longest edge by at most this share */
/* smallest distance of a flat triangle's middle corner from the ends of the longest edge, as a share of that edge, at which the
   edge is split next to the corner */
#define ASIDE 0.1
/* height of a triangle, relative to the asset's size, below which it counts as degenerate: a few rounding errors of a float */
#define LINE_OF_SIZE 2.5e-7
/* number of vertex positions for which address space is reserved, in multiples of the number in the model */
#define MORE_PLACES 12.0
#define MAX_REPORTED_EDGES 2000 /* maximum number of a coarser level's short edges that are measured for the report */
/* Number of triangles, as a share of the level's, that a round of splits must be able to add; otherwise subdividing the level
   stops. A round may add half of the triangles that remain within the level's limit. */
#define FULL 2e-4

/* limits of the number of triangles added to the finest level, as a multiple of its triangles and as a count; the larger limit applies */
#define FINEST_GROWTH 2.0
#define FINEST_GROWTH_TRIS 100000.0
#define WORTH 0.95 /* a coarser level is dropped if it would need more than this share of the next finer level's triangles */
/* used in place of WORTH with at least MANY_SENSORS sensors, whose distances then take up most of a file, or if the finest
   level reached its triangle limit */
#define WORTH_MANY 0.5
#define MANY_SENSORS 128
/* smallest number of triangles of a level whose size is first estimated from a sample; samples of smaller levels are unreliable */
#define SAMPLE_WORTH 9000
/* the same if the finest level reached its triangle limit: most coarser levels then need too many triangles, too */
#define SAMPLE_WORTH_FULL 1000
#define SAMPLE_ROUNDS 4 /* maximum number of rounds of splits on a sample; more would hardly change the estimate */
/* the same if the finest level reached its triangle limit: where many edges must be split many times, the estimate grows with each round */
#define SAMPLE_ROUNDS_FULL 8
/* minimum length of the two parts of a split edge in the finest level of detail, in multiples of the model's tolerance; short
 * because sensors may be close together */
#define SHORTEST_NEAR 0.125
/* minimum length of the two parts of a split edge in a coarser level of detail, in multiples of its error_m; at most a pixel
 * where the level is drawn */
#define SHORTEST 1.0
/* largest length of an edge that is not split at a jump of the distance; in multiples of the tolerance, in coarser levels of
   error_m */
#define JUMP_WIDTH 8
#define ON_SURFACE 0.25 /* distance from the surface, in multiples of the tolerance, up to which a point counts as on it */
/* A coarser level of detail may show at a point the value of another surface point at most this far away, in multiples of the
   level's error_m. */
#define SLACK 0.7

/* --- cutting -------------------------------------------------------------------------------------------------------------- */

#define BINS (1u << 16)
/* Returns the histogram bin of an error: positive floats sort like their bit patterns, so the upper 16 bits are a monotonic index. */
static uint32_t bin_of(float error)
{
    uint32_t bits;
    memcpy(&bits, &error, sizeof(bits));
    return bits >> 16;
}

/* Keeps the `most` findings (measured errors) with the largest errors, in their order. The threshold comes from a histogram of
 * errors; of the findings in the threshold's bin, keeps the first ones. Returns the number of findings kept. */
static size_t keep_worst(struct subdiv_finding *findings, size_t count, size_t most)
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

/* Returns whether a triangle is too narrow to be visible. */
static bool is_line(const struct subdiv *subdiv, const struct subdiv_tri *tri)
{
    double p[3][3], normal[3], longest_m = 0;
    for (int c = 0; c < 3; c++)
        for (int axis = 0; axis < 3; axis++)
            p[c][axis] = (double)subdiv_position(subdiv, tri->v[c])[axis];
    for (int c = 0; c < 3; c++)
        longest_m = max_of(longest_m, vec_distance(p[c], p[(c + 1) % 3]));
    vec_normal(p[0], p[1], p[2], normal);
    return vec_length(normal) <= LINE_OF_SIZE * subdiv->size_m * longest_m;
}

/* Returns whether an edge of a coarser level is too short to split, whatever its error. */
static bool is_too_short(const struct subdiv *subdiv, const struct subdiv_edge *edge)
{
    return !subdiv->finest && subdiv_is_short(subdiv, subdiv_length(subdiv_position(subdiv, edge->a), subdiv_position(subdiv, edge->b)));
}

/* Flags of a triangle made by the last round of splits. SIDE_* flags are per edge, shifted left by the edge's index (0 to 2). */
#define SIDE_IS_NEW 1u
#define SIDE_IS_TOO_SHORT 8u
#define ASKS 64u /* flag: the triangle is not degenerate and has edges that have not been measured */

struct sides {
    const struct subdiv *subdiv;
    unsigned char *of; /* by triangle from the last round of splits: flags of its edges (SIDE_*) */
};

static void look_at_sides(void *arg, size_t begin, size_t end)
{
    const struct sides *sides = arg;
    const struct subdiv_mesh *mesh = &sides->subdiv->mesh;
    for (size_t m = begin; m < end; m++) {
        const struct subdiv_tri *tri = &mesh->tris[mesh->made.at[m]];
        unsigned of = 0;
        for (int i = 0; i < 3; i++)
            if (mesh->cuts[tri->e[i]].error < 0)
                of |= SIDE_IS_NEW << i;
        if (of && !is_line(sides->subdiv, tri))
            of |= ASKS;
        for (int i = 0; i < 3; i++)
            if (of & ASKS && of & SIDE_IS_NEW << i && is_too_short(sides->subdiv, &mesh->cuts[tri->e[i]]))
                of |= SIDE_IS_TOO_SHORT << i;
        sides->of[m] = (unsigned char)of;
    }
}

/* Sets the error of unmeasured edges of new triangles to 0 until they are measured. asks = ASKS: visits triangles with this
 * flag, lists the edges to be measured in findings[], and returns their number. asks = 0: visits degenerate triangles, whose
 * edges need no measurement, and returns 0. */
static size_t take_new_sides(struct subdiv *subdiv, const struct sides *sides, unsigned asks, struct subdiv_finding *findings)
{
    struct subdiv_mesh *mesh = &subdiv->mesh;
    size_t count = 0;
    for (size_t m = 0; m < mesh->made.count; m++)
        for (int i = 0; i < 3 && sides->of[m] && (sides->of[m] & ASKS) == asks; i++) {
            uint32_t e = mesh->tris[mesh->made.at[m]].e[i];
            struct subdiv_edge *edge = &mesh->cuts[e];
            if (edge->error >= 0)
                continue;
            edge->error = edge->barred = 0;
            if (!asks)
                continue;
            edge->unasked = (sides->of[m] & SIDE_IS_TOO_SHORT << i) != 0;
            if (!edge->unasked)
                findings[count++].number = e;
        }
    return count;
}

/* Measures the edges made by the last round of splits. Edges of degenerate triangles only get error 0: they are invisible, and
 * splitting them would add degenerate triangles. Half of the edges of coarser levels of detail are too short to split, so their
 * error does not matter. */
static void measure_edges(struct subdiv *subdiv)
{
    struct subdiv_mesh *mesh = &subdiv->mesh;
    subdiv_mesh_sort(&mesh->made);
    struct sides sides = { subdiv, mem_array(mesh->made.count, 1) };
    workers_for(subdiv->in->workers, mesh->made.count, GRAIN, look_at_sides, &sides);
    struct subdiv_finding *findings = mem_array(3 * mesh->made.count, sizeof(*findings));
    size_t count = take_new_sides(subdiv, &sides, ASKS, findings);
    take_new_sides(subdiv, &sides, 0, findings);
    subdiv_measure_new_edges(subdiv, findings, count);
    mem_free(findings);
    mem_free(sides.of);
}

static int longest_edge(const struct subdiv *subdiv, const struct subdiv_tri *tri)
{
    int longest = 0;
    double most = 0;
    for (int i = 0; i < 3; i++) {
        double l = subdiv_length(subdiv_position(subdiv, tri->v[i]), subdiv_position(subdiv, tri->v[(i + 1) % 3]));
        if (l > most) {
            most = l;
            longest = i;
        }
    }
    return longest;
}

/* Returns whether the field's error inside a triangle may exceed the limit although its edges are good. Where a field bends
 * evenly, the error at the centre is 4/9 of the sum of the three edges' errors. In a triangle that is large compared with the
 * distance to the nearest sensor, the error inside may have any size. Such a triangle with small edge errors is measured only
 * in the last pass over the level, which has the smallest limit (SUBDIV_AIM). */
static bool inside_may_err(const struct subdiv *subdiv, const struct subdiv_tri *tri, double limit)
{
    const struct subdiv_mesh *mesh = &subdiv->mesh;
    double sum = 0;
    int i = longest_edge(subdiv, tri);
    const float *a = subdiv_position(subdiv, tri->v[i]), *b = subdiv_position(subdiv, tri->v[(i + 1) % 3]);
    double length_m = subdiv_length(a, b);
    for (int e = 0; e < 3; e++)
        sum += (double)mesh->cuts[tri->e[e]].error;
    if (length_m <= MIN_INSIDE * subdiv->shortest_m)
        return false;
    bool any_error = sum > LIKELY * limit || limit <= SUBDIV_AIM;
    const struct interp_norm *norms = subdiv->norms + mesh->welded.of_vertex[tri->v[i]] * subdiv->norm_count;
    return sum > 9 / 4.0 * limit || (any_error && length_m > LARGE * linear_error_nearest_of(subdiv->in->linear, norms));
}

struct insides {
    const struct subdiv *subdiv;
    double limit;
    char *asked; /* by triangle from the last round of splits: nonzero if the error inside must be measured */
};

static void choose_insides(void *arg, size_t begin, size_t end)
{
    const struct insides *insides = arg;
    const struct subdiv_mesh *mesh = &insides->subdiv->mesh;
    for (size_t m = begin; m < end; m++) {
        const struct subdiv_tri *tri = &mesh->tris[mesh->made.at[m]];
        double most = 0;
        for (int i = 0; i < 3; i++)
            most = max_of(most, (double)mesh->cuts[tri->e[i]].error);
        insides->asked[m] = !tri->good && most <= insides->limit && inside_may_err(insides->subdiv, tri, insides->limit);
    }
}

/* Measures the error inside triangles made by the last round of splits whose edges need no split. An error above the limit is
 * recorded at the triangle's longest edge, which is then split. */
static void measure_insides(struct subdiv *subdiv, double limit)
{
    struct subdiv_mesh *mesh = &subdiv->mesh;
    size_t count = 0;
    subdiv_mesh_sort(&mesh->made);
    struct insides insides = { subdiv, limit, mem_array(mesh->made.count, 1) };
    workers_for(subdiv->in->workers, mesh->made.count, GRAIN, choose_insides, &insides);
    for (size_t m = 0; m < mesh->made.count; m++)
        count += insides.asked[m] != 0;
    struct subdiv_finding *findings = mem_array(count, sizeof(*findings));
    count = 0;
    for (size_t m = 0; m < mesh->made.count; m++)
        if (insides.asked[m]) {
            mesh->tris[mesh->made.at[m]].good = true;
            findings[count++].number = mesh->made.at[m];
        }
    mem_free(insides.asked);
    subdiv_measure_insides(subdiv, findings, count);
    for (size_t i = 0; i < count; i++)
        if ((double)findings[i].error > SUBDIV_AIM) {
            const struct subdiv_tri *tri = &mesh->tris[findings[i].number];
            struct subdiv_edge *edge = &mesh->cuts[tri->e[longest_edge(subdiv, tri)]];
            edge->error = fmaxf(edge->error, findings[i].error);
            edge->proven = false;
        }
    mem_free(findings);
}

static void cut_edges(struct subdiv *subdiv, const struct subdiv_finding *findings, size_t count)
{
    struct subdiv_mesh *mesh = &subdiv->mesh;
    uint32_t *edges = mem_array(count, sizeof(*edges)), first = (uint32_t)mesh->welded.count;
    size_t new_count = 0;
    for (size_t i = 0; i < count; i++) {
        uint32_t e = findings[i].number;
        float point[3];
        if (subdiv_mesh_is_split(mesh, e))
            continue;
        subdiv_mix(subdiv_position(subdiv, mesh->cuts[e].a), subdiv_position(subdiv, mesh->cuts[e].b), (double)mesh->cuts[e].share, point);
        if (!subdiv_mesh_split_edge(mesh, e, point))
            continue;
        subdiv_add_place(subdiv, mesh->cuts[e].middle, subdiv->part[mesh->welded.of_vertex[mesh->cuts[e].a]]);
        edges[new_count++] = e;
    }
    subdiv_measure_places(subdiv, first, edges, new_count);
    mem_free(edges);
}

/* Finds the longest edge of a flat triangle and the fraction at which to split it: next to the opposite corner, which is close
 * to the edge. Returns false if the triangle is not flat. */
static bool find_aim(const struct subdiv *subdiv, const struct subdiv_tri *tri, uint32_t *edge, float *share)
{
    const struct subdiv_mesh *mesh = &subdiv->mesh;
    int i = longest_edge(subdiv, tri);
    uint32_t v[3] = { tri->v[i], tri->v[(i + 1) % 3], tri->v[(i + 2) % 3] };
    double ab = subdiv_length(subdiv_position(subdiv, v[0]), subdiv_position(subdiv, v[1])),
           ca = subdiv_length(subdiv_position(subdiv, v[2]), subdiv_position(subdiv, v[0])),
           cb = subdiv_length(subdiv_position(subdiv, v[2]), subdiv_position(subdiv, v[1]));
    *edge = tri->e[i];
    if (min_of(ca, cb) < max_of(subdiv->shortest_m, ASIDE * ab) || ca + cb > ab * (1 + FLAT))
        return false;
    *share = (float)((mesh->welded.of_vertex[v[0]] == mesh->welded.of_vertex[mesh->cuts[*edge].a] ? ca : cb) / (ca + cb));
    return true;
}

static bool aim_at_corner(struct subdiv *subdiv, const struct subdiv_tri *tri, uint32_t *edge)
{
    float share;
    if (!find_aim(subdiv, tri, edge, &share))
        return false;
    if (subdiv->mesh.cuts[*edge].middle == TRIMESH_NONE)
        subdiv->mesh.cuts[*edge].share = share;
    return true;
}

struct aims {
    const struct subdiv *subdiv;
    char *flat; /* by new triangle: nonzero if it is flat */
};

static void find_flat(void *arg, size_t begin, size_t end)
{
    const struct aims *aims = arg;
    const struct subdiv_mesh *mesh = &aims->subdiv->mesh;
    for (size_t m = begin; m < end; m++) {
        const struct subdiv_tri *tri = &mesh->tris[mesh->made.at[m]];
        aims->flat[m] = !tri->aimed && find_aim(aims->subdiv, tri, &(uint32_t){ 0 }, &(float){ 0 });
    }
}

/* In flat triangles made by the last round, moves the longest edge's split point next to the opposite corner. */
static void aim_at_corners(struct subdiv *subdiv)
{
    struct subdiv_mesh *mesh = &subdiv->mesh;
    struct aims aims = { subdiv, mem_array(mesh->made.count, 1) };
    workers_for(subdiv->in->workers, mesh->made.count, GRAIN, find_flat, &aims);
    for (size_t m = 0; m < mesh->made.count; m++) {
        struct subdiv_tri *tri = &mesh->tris[mesh->made.at[m]];
        if (aims.flat[m])
            aim_at_corner(subdiv, tri, &(uint32_t){ 0 });
        tri->aimed = true;
    }
    mem_free(aims.flat);
}

/* If an edge of a flat triangle is split, also splits its longest edge; otherwise the pieces would be as long as the longest edge. */
static void cut_beside_corners(struct subdiv *subdiv)
{
    struct subdiv_mesh *mesh = &subdiv->mesh;
    size_t count = 0;
    subdiv_mesh_sort(&mesh->open);
    struct subdiv_finding *findings = mem_array(mesh->open.count, sizeof(*findings));
    for (size_t m = 0; m < mesh->open.count; m++) {
        const struct subdiv_tri *tri = &mesh->tris[mesh->open.at[m]];
        bool others_cut =
            subdiv_mesh_is_split(mesh, tri->e[0]) || subdiv_mesh_is_split(mesh, tri->e[1]) || subdiv_mesh_is_split(mesh, tri->e[2]);
        if (others_cut && !is_line(subdiv, tri) && aim_at_corner(subdiv, tri, &findings[count].number) &&
            !subdiv_mesh_is_split(mesh, findings[count].number))
            count++;
    }
    cut_edges(subdiv, findings, count);
    mem_free(findings);
}

/* Lists the edges with an error above the limit, once per triangle that has them, in ascending order of triangles. */
static struct subdiv_finding *list_errors(const struct subdiv *subdiv, double limit, size_t *count)
{
    const struct subdiv_mesh *mesh = &subdiv->mesh;
    struct subdiv_list corners = { 0 };
    /* true in the first round: every triangle is new, so no list of new triangles is needed */
    bool all = mesh->made.count == mesh->tri_count;
    for (size_t t = 0; t < mesh->tri_count && all; t++)
        for (uint32_t i = 0; i < 3; i++)
            if ((double)mesh->cuts[mesh->tris[t].e[i]].error > limit)
                subdiv_mesh_list(&corners, 3 * (uint32_t)t + i);
    for (size_t m = 0; m < mesh->made.count && !all; m++)
        for (int i = 0; i < 3; i++) {
            const struct subdiv_edge *edge = &mesh->cuts[mesh->tris[mesh->made.at[m]].e[i]];
            for (uint32_t corner = edge->corner; corner != TRIMESH_NONE && (double)edge->error > limit; corner = mesh->next[corner])
                subdiv_mesh_list(&corners, corner);
        }
    subdiv_mesh_sort(&corners);
    struct subdiv_finding *findings = mem_array(corners.count, sizeof(*findings));
    for (*count = 0; *count < corners.count; ++*count) {
        uint32_t e = mesh->tris[corners.at[*count] / 3].e[corners.at[*count] % 3];
        findings[*count] = (struct subdiv_finding){ .number = e, .error = mesh->cuts[e].error };
    }
    mem_free(corners.at);
    return findings;
}

/* Splits the edges with the largest errors above the limit, as many as the level's triangle limit allows. Returns false if no
 * edge was split. */
static bool cut_worst(struct subdiv *subdiv, double limit)
{
    struct subdiv_mesh *mesh = &subdiv->mesh;
    size_t listed, room = subdiv->most_tris > mesh->tri_count ? (subdiv->most_tris - mesh->tri_count) / 2 : 0;
    subdiv_mesh_sort(&mesh->made);
    struct subdiv_finding *findings = list_errors(subdiv, limit, &listed);
    aim_at_corners(subdiv);
    subdiv->full = (double)room < FULL * (double)mesh->tri_count;
    size_t count = keep_worst(findings, listed, room);
    cut_edges(subdiv, findings, count);
    cut_beside_corners(subdiv);
    mem_free(findings);
    mesh->made.count = 0;
    bool any = count > 0 && subdiv_mesh_apply(mesh) > 0 && !subdiv->full;
    if (count < listed)
        subdiv_mesh_list_all(mesh);
    return any;
}

/* --- all ------------------------------------------------------------------------------------------------------------------ */

static void note_left(struct level *level, enum level_limit limit, float error, uint32_t edges)
{
    if ((double)error <= SUBDIV_ERROR)
        return;
    level->left[limit].edges += edges;
    level->left[limit].steps = fmaxf(level->left[limit].steps, error / (float)SUBDIV_ERROR);
}

/* For the report, measures a sample of the edges that were not measured because they are too short to split. Returns the number
 * of edges that each measured edge represents. */
static uint32_t ask_some(struct subdiv *subdiv)
{
    struct subdiv_mesh *mesh = &subdiv->mesh;
    struct subdiv_finding *findings = mem_array(mesh->edges.count, sizeof(*findings));
    size_t count = 0, asked = 0;
    for (uint32_t e = 0; e < mesh->edges.count; e++)
        if (mesh->cuts[e].unasked && mesh->cuts[e].corner != TRIMESH_NONE)
            findings[count++].number = e;
    const size_t of = 1 + count / MAX_REPORTED_EDGES;
    for (size_t i = 0; i < count; i += of)
        findings[asked++].number = findings[i].number;
    subdiv_measure_new_edges(subdiv, findings, asked);
    for (size_t i = 0; i < asked; i++)
        mesh->cuts[findings[i].number].unasked = true;
    mem_free(findings);
    return (uint32_t)of;
}

static void tell_left(struct subdiv *subdiv, struct level *level)
{
    const struct subdiv_mesh *mesh = &subdiv->mesh;
    const uint32_t of = ask_some(subdiv);
    char *told = mem_array(mesh->edges.count, 1);
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            const struct subdiv_edge *edge = &mesh->cuts[mesh->tris[t].e[i]];
            if (told[edge - mesh->cuts])
                continue;
            told[edge - mesh->cuts] = 1;
            note_left(level, LEVEL_LIMIT_TRIANGLES, edge->error, 1);
            note_left(level, edge->jumps ? LEVEL_LIMIT_JUMP : LEVEL_LIMIT_LENGTH, edge->barred, edge->unasked ? of : 1);
        }
    mem_free(told);
}

/* Splits edges in rounds until no error exceeds `limit`, or until the level of detail has reached its triangle limit. */
static void cut_to(struct subdiv *subdiv, double limit)
{
    int rounds = !subdiv->sample_blocks ? MAX_ROUNDS : subdiv->finest_full ? SAMPLE_ROUNDS_FULL : SAMPLE_ROUNDS;
    for (int round = 0; round < rounds; round++) {
        if (round == 0)
            subdiv_mesh_list_all(&subdiv->mesh);
        measure_edges(subdiv);
        if (!subdiv->finest)
            subdiv_flip_edges(subdiv, limit);
        subdiv->full = subdiv_will_exceed_bound(subdiv);
        if (subdiv->full)
            break;
        measure_insides(subdiv, limit);
        if (!cut_worst(subdiv, limit))
            break;
    }
}

/* Estimates the final size of a level of detail by splitting a sample of its triangles until no error exceeds the limit
 * `large`. Returns whether the whole level would certainly need too many triangles, so that it need not be subdivided. */
static bool is_hopeless(struct subdiv *subdiv, const struct level *level, double large)
{
    struct level sample;
    if (level->index_count / 3 < (subdiv->finest_full ? SAMPLE_WORTH_FULL : SAMPLE_WORTH))
        return false;
    subdiv->sample_blocks = subdiv_take_sample(&sample, level);
    subdiv->full = false;
    if (subdiv->sample_blocks > 1) {
        subdiv->sample_of = (double)level->index_count / (double)sample.index_count;
        subdiv_mesh_load(&subdiv->mesh, &sample);
        subdiv_place_sensors(subdiv, subdiv->error_m);
        cut_to(subdiv, large);
    }
    subdiv->sample_blocks = 0;
    level_finish(&sample);
    return subdiv->full;
}

static bool is_known_hopeless(const struct subdiv *subdiv)
{
    return subdiv->in->cache && subdiv->in->cache->hopeless >> subdiv->level & 1;
}

/* Subdivides a level of detail in several passes, each with a smaller error limit: if the level reaches its triangle limit,
 * only small errors remain. Measures nothing if the fields of all groups are evaluated at each pixel. */
static void subdivide_level(struct subdiv *subdiv, struct level *level, size_t finer_tris)
{
    static const double limits[] = { 16 * SUBDIV_AIM, 4 * SUBDIV_AIM, 2 * SUBDIV_AIM, SUBDIV_AIM };
    double error_m = (double)level->error_m, tolerance_m = surface_report(subdiv->in->surface)->tolerance_m;
    subdiv->finest = finer_tris == 0;
    subdiv->error_m = error_m;
    subdiv->on_surface_m = subdiv->finest ? ON_SURFACE * tolerance_m : max_of(ON_SURFACE * tolerance_m, 1.5 * error_m);
    subdiv->slack_m = SLACK * error_m;
    subdiv->shortest_m = subdiv->finest ? SHORTEST_NEAR * tolerance_m : max_of(tolerance_m, SHORTEST * error_m);
    subdiv->jump_m = JUMP_WIDTH * max_of(tolerance_m, SHORTEST * error_m);
    double tris = (double)(level->index_count / 3), worth = subdiv->sensors < MANY_SENSORS && !subdiv->finest_full ? WORTH : WORTH_MANY;
    subdiv->most_tris = (size_t)(subdiv->finest ? tris + max_of(FINEST_GROWTH * tris, FINEST_GROWTH_TRIS) : worth * (double)finer_tris);
    const bool cuts = subdiv->in->linear->group_count > 0;
    subdiv->full = !subdiv->finest && cuts && (is_known_hopeless(subdiv) || is_hopeless(subdiv, level, limits[0]));
    if (subdiv->full)
        return;
    subdiv_mesh_load(&subdiv->mesh, level);
    subdiv_place_sensors(subdiv, error_m);
    subdiv->full = subdiv->mesh.tri_count >= subdiv->most_tris;
    for (size_t l = 0; l < sizeof(limits) / sizeof(*limits) && cuts && !subdiv->full; l++)
        cut_to(subdiv, limits[l]);
    if (subdiv->full && !subdiv->finest)
        return;
    subdiv->finest_full |= subdiv->full;
    if (cuts) {
        measure_edges(subdiv);
        tell_left(subdiv, level);
    }
    subdiv_mesh_store(&subdiv->mesh, level);
}

/* Subdivides all levels of detail. Drops coarser levels that reach their triangle limit: the next finer level, which costs no
 * more, takes their place. */
static void subdivide_all(struct subdiv *subdiv, struct levels *levels)
{
    size_t kept = 0, finer_tris = 0;
    for (size_t l = 0; l < levels->count; l++) {
        struct level *level = &levels->at[l];
        subdiv->level = (uint32_t)l;
        subdivide_level(subdiv, level, finer_tris);
        if (finer_tris > 0 && subdiv->full) {
            if (subdiv->in->cache)
                subdiv->in->cache->given_up |= 1ull << l;
            level_finish(level);
            continue;
        }
        finer_tris = subdiv->mesh.tri_count;
        levels->at[kept++] = *level;
        if (subdiv->in->level_done)
            subdiv->in->level_done(subdiv->in->arg, &levels->at[kept - 1]);
    }
    levels->given_up = levels->count - kept;
    levels->count = kept;
}

static void set_radii(struct subdiv *subdiv)
{
    const struct welded_positions *places = &subdiv->mesh.welded;
    size_t padded = interp_padded(subdiv->sensors);
    float *largest_m[2] = { mem_array(padded, sizeof(float)), mem_array(padded, sizeof(float)) };
    float *straight_m = mem_array(padded, sizeof(*straight_m));
    for (size_t p = 0; p < places->count; p++) {
        const float *geodesic_m = subdiv->geodesic_m + p * subdiv->sensors;
        interp_euclidean(places->positions_m[p], (const float *const *)subdiv->in->linear->axes_m, padded, straight_m);
        for (size_t s = 0; s < subdiv->sensors; s++) {
            float geodesic = geodesic_m[s] < INFINITY ? geodesic_m[s] : 0;
            largest_m[DISTANCE_GEODESIC][s] = geodesic > largest_m[DISTANCE_GEODESIC][s] ? geodesic : largest_m[DISTANCE_GEODESIC][s];
            largest_m[DISTANCE_EUCLIDEAN][s] =
                straight_m[s] > largest_m[DISTANCE_EUCLIDEAN][s] ? straight_m[s] : largest_m[DISTANCE_EUCLIDEAN][s];
        }
    }
    linear_error_set_radius(subdiv->in->linear, (const float *const *)largest_m);
    mem_free(straight_m);
    mem_free(largest_m[0]);
    mem_free(largest_m[1]);
}

static bool start(struct subdiv *subdiv, struct geometry *geometry)
{
    subdiv->model = geometry->indices;
    if (!subdiv_mesh_init(&subdiv->mesh, geometry) || !subdiv_find_parts(subdiv))
        return false;
    size_t places = subdiv->mesh.welded.count;
    /* reserves room for the distances of positions that subdivision may add; the kernel provides memory only for pages in use */
    subdiv->geodesic_capacity = (size_t)(MORE_PLACES * (double)places) * subdiv->sensors;
    subdiv->geodesic_m = mem_try_array(subdiv->geodesic_capacity, sizeof(*subdiv->geodesic_m));
    if (subdiv->samples <= MAX_STORED) {
        subdiv->share_capacity = places * subdiv->samples;
        subdiv->interp = mem_try_array(subdiv->share_capacity, sizeof(*subdiv->interp));
    }
    subdiv->norm_capacity = places * subdiv->norm_count;
    subdiv->norms = mem_array(subdiv->norm_capacity, sizeof(*subdiv->norms));
    if (!subdiv->geodesic_m || (subdiv->samples <= MAX_STORED && !subdiv->interp))
        return false;
    for (uint32_t v = 0; v < geometry->vertex_count; v++)
        surface_field_at_vertex(subdiv->in->field, subdiv->in->surface, v,
                                subdiv->geodesic_m + subdiv->mesh.welded.of_vertex[v] * subdiv->sensors);
    subdiv->size_m = surface_report(subdiv->in->surface)->size_m;
    set_radii(subdiv);
    subdiv_measure_places(subdiv, 0, NULL, places);
    return true;
}

/* Moves the distances of all positions from the subdivision's state to the result. */
static void take_rows(struct subdiv *subdiv, struct distance_rows *rows)
{
    *rows = (struct distance_rows){ .distances_m = subdiv->geodesic_m,
                                    .place_of = subdiv->mesh.welded.of_vertex,
                                    .sensor_count = subdiv->sensors,
                                    .vertex_count = subdiv->mesh.geometry->vertex_count };
    subdiv->geodesic_m = NULL;
    subdiv->mesh.welded.of_vertex = NULL;
}

bool subdivide_levels(struct levels *levels, struct geometry *geometry, const struct subdiv_input *input, struct distance_rows *distances)
{
    struct subdiv subdiv = { .in = input,
                             .sensors = input->linear->sensor_count,
                             .samples = linear_error_sample_count(input->linear),
                             .norm_count = 2 * input->linear->group_count };
    bool good = start(&subdiv, geometry);
    *distances = (struct distance_rows){ 0 };
    if (good) {
        subdivide_all(&subdiv, levels);
        take_rows(&subdiv, distances);
    }
    subdiv_mesh_finish(&subdiv.mesh);
    mem_free(subdiv.geodesic_m);
    mem_free(subdiv.interp);
    mem_free(subdiv.norms);
    mem_free(subdiv.part);
    mem_free(subdiv.faces);
    return good;
}
