/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edges that run the other way between two triangles: where that helps as much as a cut, it costs no triangle. */
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "preprocess/split_impl.h"
#include "surface/vec.h"

#define MOST_TURNS 4       /* in a row */
#define FLAT_OF_ERROR 0.02 /* the surface may move so far, of the level's error */
#define GAIN 0.7           /* of the error, at most, is left */
#define CROSSING 0.02      /* of either edge: they cross at least so far from its ends */

struct pair { /* triangles at an edge */
    uint32_t tris[2], count;
};

struct turn {
    uint32_t edge, tris[2], across;
};

static struct pair *list_pairs(const struct cutmesh *mesh)
{
    struct pair *pairs = mem_array(mesh->edges.count, sizeof(*pairs));
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            struct pair *pair = &pairs[mesh->tris[t].e[i]];
            if (pair->count < 2)
                pair->tris[pair->count] = (uint32_t)t;
            pair->count++;
        }
    return pairs;
}

static void position_of(const struct split *split, uint32_t vertex, double at[3])
{
    for (int i = 0; i < 3; i++)
        at[i] = (double)split_position(split, vertex)[i];
}

/* Where the edges come nearest to each other lies within both, and there they nearly touch. */
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

static bool may_turn(const struct split *split, const struct turn *turn)
{
    const struct cut_edge *from = &split->mesh.cuts[turn->edge], *to = &split->mesh.cuts[turn->across];
    double a[3], b[3], c[3], d[3];
    position_of(split, from->a, a);
    position_of(split, from->b, b);
    position_of(split, to->a, c);
    position_of(split, to->b, d);
    return cross(a, b, c, d, FLAT_OF_ERROR * split->error_m);
}

static size_t list_turns(struct split *split, const struct pair *pairs, size_t pair_count, double limit, struct turn *turns)
{
    struct cutmesh *mesh = &split->mesh;
    size_t count = 0;
    for (uint32_t e = 0; e < pair_count; e++) {
        const struct pair *pair = &pairs[e];
        if (pair->count != 2 || !((double)mesh->cuts[e].error > limit) ||
            mesh->tris[pair->tris[0]].primitive != mesh->tris[pair->tris[1]].primitive)
            continue;
        struct turn turn = { .edge = e, .tris = { pair->tris[0], pair->tris[1] } };
        turn.across = cutmesh_across(mesh, turn.tris, e);
        if (turn.across != TRIMESH_NONE && (turn.across >= pair_count || pairs[turn.across].count == 0) && may_turn(split, &turn))
            turns[count++] = turn;
    }
    return count;
}

static void measure_across(struct split *split, const struct turn *turns, size_t count)
{
    struct cutmesh *mesh = &split->mesh;
    struct split_finding *findings = mem_array(count, sizeof(*findings));
    size_t new_count = 0;
    for (size_t i = 0; i < count; i++) {
        struct cut_edge *edge = &mesh->cuts[turns[i].across];
        if (edge->error < 0)
            findings[new_count++].number = turns[i].across;
        edge->error = fmaxf(edge->error, 0);
    }
    split_measure_new_edges(split, findings, new_count);
    mem_free(findings);
}

static float error_of(const struct cut_edge *edge)
{
    return fmaxf(edge->error, edge->barred);
}

/* Each triangle once. */
static size_t turn_better(struct split *split, const struct turn *turns, size_t count)
{
    struct cutmesh *mesh = &split->mesh;
    char *turned = mem_array(mesh->tri_count, 1);
    size_t done = 0;
    for (size_t i = 0; i < count; i++) {
        const uint32_t *tris = turns[i].tris;
        if (turned[tris[0]] || turned[tris[1]] ||
            (double)error_of(&mesh->cuts[turns[i].across]) > GAIN * (double)error_of(&mesh->cuts[turns[i].edge]))
            continue;
        cutmesh_turn(mesh, tris, turns[i].edge);
        turned[tris[0]] = turned[tris[1]] = 1;
        done++;
    }
    mem_free(turned);
    return done;
}

void split_turn_edges(struct split *split, double limit)
{
    size_t done = 1;
    for (int i = 0; i < MOST_TURNS && done > 0; i++) {
        size_t pair_count = split->mesh.edges.count;
        struct pair *pairs = list_pairs(&split->mesh);
        struct turn *turns = mem_array(pair_count, sizeof(*turns));
        size_t count = list_turns(split, pairs, pair_count, limit, turns);
        measure_across(split, turns, count);
        done = turn_better(split, turns, count);
        mem_free(pairs);
        mem_free(turns);
    }
}
