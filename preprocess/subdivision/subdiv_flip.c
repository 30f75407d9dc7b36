/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Flips edges: replaces the common edge of two triangles by the other diagonal. Where that reduces the interpolation error as
 * much as splitting the edge would, it saves a triangle. */
#include <math.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "preprocess/subdivision/subdivide_impl.h"

#define MAX_FLIP_ROUNDS 4  /* maximum number of consecutive rounds of edge flips */
#define FLAT_OF_ERROR 0.02 /* how far a flip may move the surface, as a share of the level's error_m */
#define GAIN 0.7           /* an edge is flipped only if that multiplies the interpolation error by at most this */
#define CROSSING 0.02      /* smallest distance of the diagonals' crossing from the ends of each diagonal, as a share of its length */

#define GRAIN 1024 /* number of flips that a thread processes per unit of work, which takes a few tenths of a millisecond */

struct edge_flip {
    uint32_t edge, tris[2], across;
    bool may; /* true: the flip is allowed: the diagonals cross, and the surface moves by no more than FLAT_OF_ERROR allows */
};

/* Lists the edges with an error above the limit in triangles made since the last call: mesh->made.at[first] and later. */
static void list_edges(struct subdiv *subdiv, double limit, size_t first, struct subdiv_list *edges)
{
    const struct subdiv_mesh *mesh = &subdiv->mesh;
    for (size_t m = first; m < mesh->made.count; m++)
        for (int i = 0; i < 3; i++) {
            uint32_t e = mesh->tris[mesh->made.at[m]].e[i];
            if ((double)mesh->cuts[e].error > limit)
                subdiv_mesh_list(edges, e);
        }
    subdiv_mesh_sort(edges);
}

/* Finds the two triangles at an edge. Returns false if the edge has more or fewer triangles. */
static bool find_tris(const struct subdiv_mesh *mesh, uint32_t edge, uint32_t tris[2])
{
    uint32_t first = mesh->cuts[edge].corner, second = first == TRIMESH_NONE ? first : mesh->next[first];
    if (second == TRIMESH_NONE || mesh->next[second] != TRIMESH_NONE)
        return false;
    tris[0] = (first < second ? first : second) / 3;
    tris[1] = (first < second ? second : first) / 3;
    return true;
}

/* --- flipping one edge ------------------------------------------------------------------------------------------------------- */

static void position_of(const struct subdiv *subdiv, uint32_t vertex, double at[3])
{
    for (int i = 0; i < 3; i++)
        at[i] = (double)subdiv_position(subdiv, vertex)[i];
}

/* Returns whether the closest points of the edges a-b and c-d lie inside both edges and at most apart_m from each other. */
static bool cross(const double a[3], const double b[3], const double c[3], const double d[3], double apart_m)
{
    double ab[3], cd[3], ac[3], normal[3], side[3];
    vec_sub(b, a, ab);
    vec_sub(d, c, cd);
    vec_sub(c, a, ac);
    vec_cross(ab, cd, normal);
    double square = vec_dot(normal, normal);
    if (!(square > 0) || fabs(vec_dot(ac, normal)) > apart_m * sqrt(square))
        return false;
    vec_cross(ac, cd, side);
    double along_ab = vec_dot(side, normal) / square;
    vec_cross(ac, ab, side);
    double along_cd = vec_dot(side, normal) / square;
    return along_ab > CROSSING && along_ab < 1 - CROSSING && along_cd > CROSSING && along_cd < 1 - CROSSING;
}

struct turns {
    const struct subdiv *subdiv;
    struct edge_flip *at;
};

static void try_turns(void *arg, size_t begin, size_t end)
{
    const struct turns *turns = arg;
    const struct subdiv *subdiv = turns->subdiv;
    for (size_t i = begin; i < end; i++) {
        const struct subdiv_edge *from = &subdiv->mesh.cuts[turns->at[i].edge], *to = &subdiv->mesh.cuts[turns->at[i].across];
        double a[3], b[3], c[3], d[3];
        position_of(subdiv, from->a, a);
        position_of(subdiv, from->b, b);
        position_of(subdiv, to->a, c);
        position_of(subdiv, to->b, d);
        turns->at[i].may = cross(a, b, c, d, FLAT_OF_ERROR * subdiv->error_m);
    }
}

static size_t list_turns(struct subdiv *subdiv, const struct subdiv_list *edges, struct edge_flip *turns)
{
    struct subdiv_mesh *mesh = &subdiv->mesh;
    size_t count = 0, kept = 0;
    for (size_t i = 0; i < edges->count; i++) {
        struct edge_flip turn = { .edge = edges->at[i] };
        if (!find_tris(mesh, turn.edge, turn.tris) || mesh->tris[turn.tris[0]].primitive != mesh->tris[turn.tris[1]].primitive)
            continue;
        turn.across = subdiv_mesh_opposite_edge(mesh, turn.tris, turn.edge);
        if (turn.across != TRIMESH_NONE && mesh->cuts[turn.across].corner == TRIMESH_NONE)
            turns[count++] = turn;
    }
    workers_for(subdiv->in->workers, count, GRAIN, try_turns, &(struct turns){ subdiv, turns });
    for (size_t i = 0; i < count; i++)
        if (turns[i].may)
            turns[kept++] = turns[i];
    return kept;
}

static void measure_across(struct subdiv *subdiv, const struct edge_flip *turns, size_t count)
{
    struct subdiv_mesh *mesh = &subdiv->mesh;
    struct subdiv_finding *findings = mem_array(count, sizeof(*findings));
    size_t new_count = 0;
    for (size_t i = 0; i < count; i++) {
        struct subdiv_edge *edge = &mesh->cuts[turns[i].across];
        if (edge->error < 0 || edge->unasked)
            findings[new_count++].number = turns[i].across;
        edge->error = fmaxf(edge->error, 0);
    }
    subdiv_measure_new_edges(subdiv, findings, new_count);
    mem_free(findings);
}

static float error_of(const struct subdiv_edge *edge)
{
    return fmaxf(edge->error, edge->barred);
}

/* Applies the flips that reduce the error, at most one per triangle. Returns their number. */
static size_t turn_better(struct subdiv *subdiv, const struct edge_flip *turns, size_t count)
{
    struct subdiv_mesh *mesh = &subdiv->mesh;
    char *turned = mem_array(mesh->tri_count, 1);
    size_t done = 0;
    for (size_t i = 0; i < count; i++) {
        const uint32_t *tris = turns[i].tris;
        if (turned[tris[0]] || turned[tris[1]] ||
            (double)error_of(&mesh->cuts[turns[i].across]) > GAIN * (double)error_of(&mesh->cuts[turns[i].edge]))
            continue;
        subdiv_mesh_flip_edge(mesh, tris, turns[i].edge, turns[i].across);
        turned[tris[0]] = turned[tris[1]] = 1;
        done++;
    }
    mem_free(turned);
    return done;
}

void subdiv_flip_edges(struct subdiv *subdiv, double limit)
{
    struct subdiv_list edges = { 0 };
    size_t done = 1, listed = 0;
    for (int i = 0; i < MAX_FLIP_ROUNDS && done > 0; i++) {
        list_edges(subdiv, limit, listed, &edges);
        listed = subdiv->mesh.made.count;
        struct edge_flip *turns = mem_array(edges.count, sizeof(*turns));
        size_t count = list_turns(subdiv, &edges, turns);
        measure_across(subdiv, turns, count);
        done = turn_better(subdiv, turns, count);
        mem_free(turns);
    }
    mem_free(edges.at);
}
