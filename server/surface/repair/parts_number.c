/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Divides the mesh into parts (parts.h). Finds patches (triangles connected by edges with two faces), fins that stand on
   patches, and the patches that form each part. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "surface/repair/parts_impl.h"

/* A part counts as closed if the total length of its open edges is at most this, relative to the square root of its area. The
   limit is above the remnants of a hair gap, but below the rim of a pipe's end. */
#define MAX_OPEN_OF_SIZE 0.05
/* A patch (triangles connected by edges with two faces) counts as a body of its own if its border is at most this long,
   relative to the square root of its area. */
#define MAX_BODY_OPEN_OF_SIZE 0.5

static double edge_length(const struct trimesh *mesh, size_t t, int i)
{
    return vec_distance(mesh->points[mesh->tris[t][i]], mesh->points[mesh->tris[t][(i + 1) % 3]]);
}

static void find_patches(struct parts_finding *f)
{
    const struct trimesh *mesh = &f->parts->solid;
    for (uint32_t t = 0; t < mesh->tri_count; t++)
        f->patch[t] = t;
    for (uint32_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++)
            if (tri_edges_at(&f->edges, t, i)->faces == 2)
                trimesh_join(f->patch, t, tri_edges_at(&f->edges, t, i)->sides[0] / 3);
    for (uint32_t t = 0; t < mesh->tri_count; t++)
        f->patch[t] = trimesh_root(f->patch, t);
}

/* --- connected patches -------------------------------------------------------------------------------------------------------- */

/* Patches at edges with three or more faces: one entry per edge and patch, sorted by edge. A patch with two faces at the edge continues
 * through it. A patch with one face only stands on the others, like a fin. */
struct branches {
    struct open_branch {
        uint32_t edge, patch, faces;
        /* true: one of the patches (triangles connected by edges with two faces) has two faces at this edge, so it continues through the
           edge */
        bool runs_through;
        double length_m;
    } * at;
    size_t count;
};

static int compare_branches(const void *a, const void *b)
{
    const struct open_branch *x = a, *y = b;
    if (x->edge != y->edge)
        return x->edge < y->edge ? -1 : 1;
    return (x->patch > y->patch) - (x->patch < y->patch);
}

static void branches_init(struct branches *b, const struct parts_finding *f)
{
    size_t capacity = 0, count = 0;
    *b = (struct branches){ 0 };
    for (size_t t = 0; t < f->parts->solid.tri_count; t++)
        for (int i = 0; i < 3; i++) {
            if (tri_edges_at(&f->edges, t, i)->faces < 3)
                continue;
            mem_grow(&b->at, &capacity, b->count + 1, sizeof(*b->at));
            b->at[b->count++] = (struct open_branch){ .edge = f->edges.of_side[3 * t + (size_t)i],
                                                      .patch = f->patch[t],
                                                      .faces = 1,
                                                      .length_m = edge_length(&f->parts->solid, t, i) };
        }
    if (b->count)
        qsort(b->at, b->count, sizeof(*b->at), compare_branches);
    for (size_t i = 0; i < b->count; i++)
        if (count && !compare_branches(&b->at[count - 1], &b->at[i]))
            b->at[count - 1].faces++;
        else
            b->at[count++] = b->at[i];
    b->count = count;
    for (size_t first = 0, end; first < b->count; first = end) {
        bool through = false;
        for (end = first; end < b->count && b->at[end].edge == b->at[first].edge; end++)
            through = through || b->at[end].faces > 1;
        for (size_t i = first; i < end; i++)
            b->at[i].runs_through = through;
    }
}

static void measure_patches(struct parts_finding *f, const struct branches *b)
{
    const struct trimesh *mesh = &f->parts->solid;
    for (size_t t = 0; t < mesh->tri_count; t++) {
        struct surface_patch *patch = &f->patches[f->patch[t]];
        double n[3];
        trimesh_normal(mesh, t, n);
        patch->area_m2 += vec_length(n) / 2;
        for (int i = 0; i < 3; i++)
            patch->open_m += tri_edges_at(&f->edges, t, i)->faces == 1 ? edge_length(mesh, t, i) : 0;
    }
    for (size_t i = 0; i < b->count; i++)
        f->patches[b->at[i].patch].branching_m += b->at[i].faces == 1 ? b->at[i].length_m : 0;
}

static bool stands(const struct open_branch *branch)
{
    return branch->runs_through && branch->faces == 1;
}

/* A set of patches (triangles connected by edges with two faces) that meet at edges where every patch ends. The total length of
   its open edges (open_m) and its area tell whether the set is closed. stands: a patch of the set ends at an edge where another
   patch continues. Stored at the index of the set's lowest triangle */
struct core {
    double open_m, area_m2;
    bool stands;
};

static bool is_closed(double open_m, double area_m2)
{
    return open_m <= MAX_OPEN_OF_SIZE * sqrt(area_m2);
}

/* Joins patches (triangles connected by edges with two faces) that meet at edges into parts. Two closed sets of patches stay
 * separate where one only stands on the other, or on a fin of the other. So a seam that joins fins of two bodies does not make
 * the bodies one part. of[triangle] on entry: its patch; on return: its part. Both are identified by their lowest triangle. */
static void join_patches(struct parts_finding *f, const struct branches *b, uint32_t *of)
{
    size_t tri_count = f->parts->solid.tri_count;
    struct core *cores = mem_array(tri_count, sizeof(*cores));
    /* by lowest triangle of a part: 1 if the part contains patches (triangles connected by edges with two faces) that together
     * are closed */
    char *holds = mem_array(tri_count, 1);
    for (size_t i = 1; i < b->count; i++)
        if (b->at[i].edge == b->at[i - 1].edge && !b->at[i].runs_through)
            trimesh_join(of, b->at[i - 1].patch, b->at[i].patch);
    for (uint32_t t = 0; t < tri_count; t++) {
        struct core *core = &cores[trimesh_root(of, t)];
        core->open_m += f->patches[t].open_m;
        core->area_m2 += f->patches[t].area_m2;
    }
    for (size_t i = 0; i < b->count; i++)
        cores[trimesh_root(of, b->at[i].patch)].stands |= stands(&b->at[i]);
    for (uint32_t t = 0; t < tri_count; t++) {
        const struct core *core = &cores[trimesh_root(of, t)];
        f->patches[t].loose = core->stands && !is_closed(core->open_m, core->area_m2);
        holds[t] = trimesh_root(of, t) == t && is_closed(core->open_m, core->area_m2);
    }
    for (size_t i = 1; i < b->count; i++) {
        uint32_t one = trimesh_root(of, b->at[i - 1].patch), other = trimesh_root(of, b->at[i].patch);
        if (b->at[i].edge != b->at[i - 1].edge || one == other || (holds[one] && holds[other]))
            continue;
        trimesh_join(of, one, other);
        holds[trimesh_root(of, one)] = holds[one] || holds[other];
    }
    mem_free(cores);
    mem_free(holds);
}

/* Assigns indices to parts, from 0 in the order of their lowest triangles. */
static void number_parts(struct parts_finding *f, const struct branches *b)
{
    struct body_parts *parts = f->parts;
    size_t tri_count = parts->solid.tri_count;
    uint32_t *number = mem_array(tri_count, sizeof(*number)), *part = parts->of_tri;
    memcpy(part, f->patch, tri_count * sizeof(*part));
    join_patches(f, b, part);
    /* the lowest triangle of a part is visited first: it gets the part's index, which the part's other triangles copy */
    for (uint32_t t = 0; t < tri_count; t++)
        number[t] = trimesh_root(part, t) == t ? (uint32_t)parts->count++ : number[trimesh_root(part, t)];
    memcpy(part, number, tri_count * sizeof(*part));
    mem_free(number);
}

static void find_closed(struct parts_finding *f)
{
    struct body_parts *parts = f->parts;
    const struct trimesh *mesh = &parts->solid;
    double *area_m2 = mem_array(parts->count, sizeof(*area_m2)), *open_m = mem_array(parts->count, sizeof(*open_m));
    for (size_t t = 0; t < mesh->tri_count; t++) {
        double n[3], open = 0;
        /* open edges of a triangle do not count if it belongs to a fin (a sheet that stands on a body), or has an edge at which
           two other triangles already close the surface */
        bool fin = f->patches[f->patch[t]].loose;
        trimesh_normal(mesh, t, n);
        area_m2[parts->of_tri[t]] += vec_length(n) / 2;
        for (int i = 0; i < 3; i++) {
            const struct tri_edge *edge = tri_edges_at(&f->edges, t, i);
            open += edge->faces == 1 ? edge_length(mesh, t, i) : 0;
            fin = fin || edge->faces > 2;
            parts->tangled[parts->of_tri[t]] |= edge->faces > 2;
        }
        open_m[parts->of_tri[t]] += fin ? 0 : open;
    }
    for (size_t p = 0; p < parts->count; p++)
        parts->closed[p] = is_closed(open_m[p], area_m2[p]);
    mem_free(area_m2);
    mem_free(open_m);
}

/* Assigns bodies: usually the parts. A patch (triangles connected by edges with two faces) that is nearly closed by itself is a
 * body of its own. Only a few edges join it to its part, because of an error in the model. */
static void find_bodies(struct parts_finding *f, const struct trimesh *mesh)
{
    struct body_parts *parts = f->parts;
    for (size_t t = 0; t < mesh->tri_count; t++) {
        const struct surface_patch *patch = &f->patches[f->patch[t]];
        bool alone = patch->branching_m > 0 && patch->open_m + patch->branching_m < MAX_BODY_OPEN_OF_SIZE * sqrt(patch->area_m2);
        parts->body_of_source[mesh->tri_source[t]] = alone ? (uint32_t)parts->count + f->patch[t] : parts->of_tri[t];
    }
}

void parts_number(struct parts_finding *f, const struct trimesh *mesh)
{
    struct body_parts *parts = f->parts;
    struct branches branches;
    tri_edges_init(&f->edges, (const uint32_t(*)[3])mesh->tris, mesh->tri_count);
    find_patches(f);
    branches_init(&branches, f);
    measure_patches(f, &branches);
    number_parts(f, &branches);
    mem_free(branches.at);
    for (size_t t = 0; t < mesh->tri_count; t++)
        parts->of_source[mesh->tri_source[t]] = parts->of_tri[t];
    parts->closed = mem_array(parts->count, 1);
    parts->tangled = mem_array(parts->count, 1);
    parts->crossed = mem_array(parts->count, 1);
    find_closed(f);
    find_bodies(f, mesh);
}
