/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Orients the faces of parts outwards and finds walls within parts. Limits the reach of thin parts, that is, the distance up to
 * which a part counts as touching. */
#include "surface/repair/parts.h"

#include <math.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "surface/repair/parts_impl.h"

/* A wall is a face where two bodies touch, so the model has its triangles twice, once for each body. Minimum fraction of a
   patch's area that must occur twice for the patch to count as a wall. It is below 1, because a slit in one of the two layers
   leaves triangles that occur only once. */
#define MIN_DOUBLED_SHARE 0.75
#define OF_THICKNESS 0.5
#define MIN_REACH 0.05 /* smallest reach, in tolerances */

/* --- orientation of patches ----------------------------------------------------------------------------------------------- */

/* Reverses patches (triangles connected by edges with two faces) whose signed volume, relative to their centre, is negative, so that all
 * patches face outwards. */
static void face_outwards(struct parts_finding *f)
{
    const struct trimesh *mesh = &f->parts->solid;
    signed char *side = f->parts->side;
    struct part_middle {
        double middle[3], volume;
        size_t corners;
    } *votes = mem_array(mesh->tri_count, sizeof(*votes));
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            struct part_middle *vote = &votes[f->patch[t]];
            for (int axis = 0; axis < 3; axis++)
                vote->middle[axis] += mesh->points[mesh->tris[t][i]][axis];
            vote->corners++;
        }
    for (size_t t = 0; t < mesh->tri_count; t++) {
        struct part_middle *vote = &votes[f->patch[t]];
        double from[3], n[3];
        for (int axis = 0; axis < 3; axis++)
            from[axis] = mesh->points[mesh->tris[t][0]][axis] - vote->middle[axis] / (double)vote->corners;
        trimesh_normal(mesh, t, n);
        vote->volume += side[t] * vec_dot(from, n);
    }
    for (size_t t = 0; t < mesh->tri_count; t++)
        if (votes[f->patch[t]].volume < 0)
            side[t] = (signed char)-side[t];
    mem_free(votes);
}

/* Finds walls and fins, which bound no body, and sets body_parts.side to 0 for their triangles. A wall is a patch (triangles
   connected by edges with two faces) where two bodies touch with identical vertices, so that welding left one face of two. It
   ends at edges with three or more faces, and its triangles occur in the model at least twice as often as the part's least
   frequent ones. A fin is a sheet that stands on a surface. */
static void drop_walls(struct parts_finding *f, const uint32_t *times)
{
    struct body_parts *parts = f->parts;
    const struct trimesh *mesh = &parts->solid;
    uint32_t *least = mem_array(parts->count, sizeof(*least));
    for (size_t t = 0; t < mesh->tri_count; t++) {
        uint32_t *low = &least[parts->of_tri[t]];
        *low = !*low || times[t] < *low ? times[t] : *low;
    }
    for (size_t t = 0; t < mesh->tri_count; t++) {
        struct surface_patch *patch = &f->patches[f->patch[t]];
        double n[3];
        trimesh_normal(mesh, t, n);
        patch->doubles_m2 += times[t] >= 2 * least[parts->of_tri[t]] ? vec_length(n) / 2 : 0;
    }
    for (size_t t = 0; t < mesh->tri_count; t++) {
        const struct surface_patch *patch = &f->patches[f->patch[t]];
        bool fin = patch->open_m > patch->branching_m, wall = patch->doubles_m2 > MIN_DOUBLED_SHARE * patch->area_m2;
        if (patch->loose || (patch->branching_m > 0 && (fin || wall)))
            parts->side[t] = 0;
    }
    mem_free(least);
}

/* --- reach: the distance up to which parts count as touching --- */

/* Limits the reach (distance up to which a part counts as touching) of closed parts to half of their thickness. The thickness
 * is estimated as twice the volume divided by the area, which is exact for plates; other bodies are thicker. */
static void limit_reach(struct body_parts *parts, double tolerance_m)
{
    const struct trimesh *mesh = &parts->solid;
    double *area_m2 = mem_array(parts->count, sizeof(*area_m2)), *volume_m3 = mem_array(parts->count, sizeof(*volume_m3));
    uint32_t *first = mem_array(parts->count, sizeof(*first));
    for (size_t t = mesh->tri_count; t-- > 0;)
        first[parts->of_tri[t]] = mesh->tris[t][0];
    for (size_t t = 0; t < mesh->tri_count; t++) {
        uint32_t part = parts->of_tri[t];
        double from[3], n[3];
        trimesh_normal(mesh, t, n);
        vec_sub(mesh->points[mesh->tris[t][0]], mesh->points[first[part]], from);
        area_m2[part] += vec_length(n) / 2;
        volume_m3[part] += parts->side[t] * vec_dot(from, n) / 6;
    }
    for (size_t p = 0; p < parts->count; p++)
        if (parts->closed[p]) {
            double thickness_m = 2 * fabs(volume_m3[p]) / area_m2[p];
            parts->reach_m[p] = min_of(tolerance_m, max_of(OF_THICKNESS * thickness_m, MIN_REACH * tolerance_m));
            parts->thin[p] = parts->reach_m[p] < tolerance_m;
        }
    mem_free(area_m2);
    mem_free(volume_m3);
    mem_free(first);
}

/* --- all ------------------------------------------------------------------------------------------------------------------ */

void parts_init(struct body_parts *parts, const struct trimesh *mesh, size_t source_count, double tolerance_m, bool is_chosen)
{
    struct parts_finding f = { .parts = parts };
    *parts = (struct body_parts){ .source_count = source_count };
    trimesh_copy(&parts->solid, mesh);
    parts->of_tri = mem_array(mesh->tri_count, sizeof(*parts->of_tri));
    parts->side = mem_array(mesh->tri_count, 1);
    parts->of_source = mem_array(source_count, sizeof(*parts->of_source));
    parts->body_of_source = mem_array(source_count, sizeof(*parts->body_of_source));
    f.patch = mem_array(mesh->tri_count, sizeof(*f.patch));
    f.patches = mem_array(mesh->tri_count, sizeof(*f.patches));
    parts_number(&f, mesh);
    tri_edges_orient_all(&f.edges, parts->side);
    face_outwards(&f);
    drop_walls(&f, mesh->tri_times);
    parts->reach_m = mem_array(parts->count, sizeof(*parts->reach_m));
    parts->thin = mem_array(parts->count, 1);
    for (size_t p = 0; p < parts->count; p++)
        parts->reach_m[p] = tolerance_m;
    if (is_chosen)
        limit_reach(parts, tolerance_m);
    parts->tolerance_m = tolerance_m;
    parts->side_of_source = mem_array(source_count, 1);
    for (size_t t = 0; t < mesh->tri_count; t++)
        parts->side_of_source[mesh->tri_source[t]] = parts->side[t];
    tri_edges_finish(&f.edges);
    mem_free(f.patch);
    mem_free(f.patches);
}

void parts_finish(struct body_parts *parts)
{
    trimesh_finish(&parts->solid);
    mem_free(parts->of_tri);
    mem_free(parts->side);
    mem_free(parts->of_source);
    mem_free(parts->body_of_source);
    mem_free(parts->side_of_source);
    mem_free(parts->closed);
    mem_free(parts->tangled);
    mem_free(parts->crossed);
    mem_free(parts->thin);
    mem_free(parts->reach_m);
}

uint32_t *parts_spread(const struct trimesh *mesh, const uint32_t *of_source)
{
    uint32_t *of = mem_array(mesh->tri_count, sizeof(*of));
    for (size_t t = 0; t < mesh->tri_count; t++)
        of[t] = of_source[mesh->tri_source[t]];
    return of;
}
