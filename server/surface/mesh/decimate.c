/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decimates a mesh (decimate.h): collapses an edge onto one of its ends where this leaves the shape of the surface unchanged. */
#include "surface/mesh/decimate.h"

#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"

#define MAX_STAR 48 /* maximum number of triangles around a point (its star) for the point to be removed; also the size of arrays */
/* A collapse moves a point onto a neighbour, to remove the point. It must not create a triangle whose height is below this fraction of its
   longest side, unless the triangle was thinner before. */
#define MIN_HEIGHT 0.02
#define ROUNDING_OF_AREA 1e-9

struct thin {
    struct trimesh *mesh;
    const struct decimate_params *params;
    char *hidden, *gone; /* per triangle */
    uint32_t *plane;
    /* lists of the triangle corners (3 * triangle + corner) at each point. heads, tails: by point, first and last corner of its
     * list; next: by corner, next corner of the list */
    uint32_t *heads, *tails, *next;
};

struct star_face { /* triangle of a star; a star is the set of triangles around a point */
    uint32_t tri, corner;
    /* normal: normal vector of the triangle; length: length of that vector, which is twice the triangle's area */
    double normal[3], length;
};

struct star {
    uint32_t point;
    struct star_face faces[MAX_STAR];
    size_t count;
    double longest_m; /* longest side at the point */
};

static const double *point_of(const struct thin *thin, uint32_t point)
{
    return thin->mesh->points[point];
}

static uint32_t corner_of(const struct thin *thin, const struct star_face *face, uint32_t after)
{
    return thin->mesh->tris[face->tri][(face->corner + after) % 3];
}

/* Collects the star of a point: the triangles around it. Returns false if there are none, or more than MAX_STAR. */
static bool collect_star(const struct thin *thin, uint32_t point, struct star *star)
{
    star->point = point;
    star->count = 0;
    star->longest_m = 0;
    for (uint32_t corner = thin->heads[point]; corner != TRIMESH_NONE; corner = thin->next[corner]) {
        if (thin->gone[corner / 3])
            continue;
        if (star->count == MAX_STAR)
            return false;
        struct star_face *face = &star->faces[star->count++];
        *face = (struct star_face){ .tri = corner / 3, .corner = corner % 3 };
        const double *b = point_of(thin, corner_of(thin, face, 1)), *c = point_of(thin, corner_of(thin, face, 2));
        vec_normal(point_of(thin, point), b, c, face->normal);
        face->length = sqrt(vec_dot(face->normal, face->normal));
        star->longest_m = max_of(star->longest_m, max_of(vec_distance(point_of(thin, point), b), vec_distance(point_of(thin, point), c)));
    }
    return star->count > 0;
}

/* Checks a triangle of the star as it would be after the point has moved to a neighbour. Returns false if the triangle would leave its
 * plane, turn over, or become too thin. *length receives twice the new area. */
static bool can_take(const struct thin *thin, const struct star *star, const struct star_face *face, const double to[3], double *length)
{
    const double *a = point_of(thin, star->point), *b = point_of(thin, corner_of(thin, face, 1));
    const double *c = point_of(thin, corner_of(thin, face, 2));
    double way[3], normal[3];
    vec_sub(to, a, way);
    if (face->length <= 0 || fabs(vec_dot(way, face->normal)) > thin->params->within_m * face->length)
        return false;
    vec_normal(to, b, c, normal);
    *length = vec_length(normal);
    double longest_m = max_of(vec_distance(to, b), vec_distance(to, c));
    return vec_dot(normal, face->normal) > 0 && longest_m <= max_of(thin->params->longest_m, star->longest_m) &&
           *length >= min_of(face->length, MIN_HEIGHT * longest_m * longest_m);
}

static bool same_part(const struct thin *thin, uint32_t s, uint32_t t)
{
    return thin->params->part[s] == thin->params->part[t];
}

/* Returns whether every part keeps its visible and its hidden area when a point is removed. star: the triangles around the
   point; grown: [triangle of the star]: change of twice its area; enough: tolerance for the sum of these changes. */
static bool keeps_areas(const struct thin *thin, const struct star *star, const double grown[MAX_STAR], double enough)
{
    for (size_t i = 0; i < star->count; i++) {
        double sum = 0;
        for (size_t j = 0; j < star->count; j++) {
            uint32_t s = star->faces[i].tri, t = star->faces[j].tri;
            sum += same_part(thin, s, t) && thin->hidden[s] == thin->hidden[t] ? grown[j] : 0;
        }
        if (fabs(sum) > enough)
            return false;
    }
    return true;
}

/* Collapsing `from` into `to` removes the triangle with the corners `from`, `to` and `point`. Returns whether `point` keeps
   another visible triangle at `from` or `to`. Checked because a removed triangle without area may be the only connection
   between two parts. */
static bool stays_joined(const struct thin *thin, uint32_t point, uint32_t from, uint32_t to)
{
    for (uint32_t corner = thin->heads[point]; corner != TRIMESH_NONE; corner = thin->next[corner]) {
        uint32_t tri = corner / 3;
        if (!thin->gone[tri] && !thin->hidden[tri] && trimesh_has(thin->mesh, tri, from) != trimesh_has(thin->mesh, tri, to))
            return true;
    }
    return false;
}

static bool can_go_to(const struct thin *thin, const struct star *star, uint32_t to)
{
    double grown[MAX_STAR], all = 0;
    for (size_t i = 0; i < star->count; i++) {
        const struct star_face *face = &star->faces[i];
        double length = 0;
        bool at_both = corner_of(thin, face, 1) == to || corner_of(thin, face, 2) == to;
        if (!at_both && !can_take(thin, star, face, point_of(thin, to), &length))
            return false;
        grown[i] = length - face->length;
        all += length + face->length;
    }
    if (!keeps_areas(thin, star, grown, thin->params->within_m * star->longest_m + ROUNDING_OF_AREA * all))
        return false;
    for (size_t i = 0; i < star->count; i++) {
        const struct star_face *face = &star->faces[i];
        uint32_t b = corner_of(thin, face, 1), c = corner_of(thin, face, 2);
        if (!thin->hidden[face->tri] && (b == to || c == to) && !stays_joined(thin, b == to ? c : b, star->point, to))
            return false;
    }
    return true;
}

/* Returns the nearest neighbour into which the point can be collapsed, or TRIMESH_NONE. */
static uint32_t find_collapse_target(const struct thin *thin, const struct star *star)
{
    uint32_t best = TRIMESH_NONE;
    double best_m = INFINITY;
    for (size_t i = 0; i < 2 * star->count; i++) {
        uint32_t to = corner_of(thin, &star->faces[i / 2], 1 + i % 2);
        double distance_m = vec_distance(point_of(thin, star->point), point_of(thin, to));
        if (to != star->point && distance_m < best_m && can_go_to(thin, star, to)) {
            best = to;
            best_m = distance_m;
        }
    }
    return best;
}

/* Merges the planes (groups of coplanar model triangles) of all triangles around the removed point, because the collapse may
   have moved a piece of one model triangle onto another. */
static void join_planes(struct thin *thin, const struct star *star)
{
    for (size_t i = 0; i < star->count; i++)
        for (size_t j = 0; j < i; j++) {
            const struct star_face *a = &star->faces[i], *b = &star->faces[j];
            uint32_t from = thin->mesh->tri_source[a->tri], to = thin->mesh->tri_source[b->tri];
            double across[3];
            vec_cross(a->normal, b->normal, across);
            if (from != to && same_part(thin, a->tri, b->tri) &&
                vec_length(across) * star->longest_m <= 8 * thin->params->within_m * a->length * b->length)
                trimesh_join(thin->plane, from, to);
        }
}

static void collapse(struct thin *thin, const struct star *star, uint32_t to)
{
    for (size_t i = 0; i < star->count; i++) {
        const struct star_face *face = &star->faces[i];
        thin->gone[face->tri] = corner_of(thin, face, 1) == to || corner_of(thin, face, 2) == to;
        thin->mesh->tris[face->tri][face->corner] = to;
    }
    thin->next[thin->tails[to]] = thin->heads[star->point];
    thin->tails[to] = thin->tails[star->point];
    thin->heads[star->point] = thin->tails[star->point] = TRIMESH_NONE;
}

static void list_corners(struct thin *thin)
{
    const struct trimesh *mesh = thin->mesh;
    memset(thin->heads, 0xff, mesh->point_count * sizeof(*thin->heads));
    memset(thin->tails, 0xff, mesh->point_count * sizeof(*thin->tails));
    for (uint32_t corner = 0; corner < 3 * mesh->tri_count; corner++) {
        uint32_t point = mesh->tris[corner / 3][corner % 3];
        thin->next[corner] = TRIMESH_NONE;
        if (thin->heads[point] == TRIMESH_NONE)
            thin->heads[point] = corner;
        else
            thin->next[thin->tails[point]] = corner;
        thin->tails[point] = corner;
    }
}

/* Removes the triangles and points that are marked as deleted from the mesh's arrays, and renumbers the others. */
static void compact(struct thin *thin, uint32_t *target)
{
    struct trimesh *mesh = thin->mesh;
    size_t points = 0, tris = 0;
    for (uint32_t p = 0; p < mesh->point_count; p++) {
        target[p] = !thin->params->keep[p] && thin->heads[p] == TRIMESH_NONE ? TRIMESH_NONE : (uint32_t)points;
        if (target[p] != TRIMESH_NONE)
            memmove(mesh->points[points++], mesh->points[p], sizeof(*mesh->points));
    }
    for (size_t t = 0; t < mesh->tri_count; t++) {
        if (thin->gone[t])
            continue;
        for (int i = 0; i < 3; i++)
            mesh->tris[tris][i] = target[mesh->tris[t][i]];
        mesh->tri_source[tris] = mesh->tri_source[t];
        thin->hidden[tris++] = thin->hidden[t];
    }
    mesh->point_count = points;
    mesh->tri_count = tris;
}

void decimate_mesh(struct trimesh *mesh, char *hidden, const struct decimate_params *params, uint32_t *plane, size_t source_count,
                   uint32_t *target)
{
    struct thin thin = { .mesh = mesh, .params = params, .hidden = hidden, .plane = plane };
    struct star star;
    thin.gone = mem_array(mesh->tri_count, 1);
    thin.heads = mem_array(mesh->point_count, sizeof(*thin.heads));
    thin.tails = mem_array(mesh->point_count, sizeof(*thin.tails));
    thin.next = mem_array(3 * mesh->tri_count, sizeof(*thin.next));
    list_corners(&thin);
    for (uint32_t p = 0; p < mesh->point_count; p++) {
        uint32_t to = !params->keep[p] && collect_star(&thin, p, &star) ? find_collapse_target(&thin, &star) : TRIMESH_NONE;
        if (to == TRIMESH_NONE)
            continue;
        join_planes(&thin, &star);
        collapse(&thin, &star, to);
    }
    for (uint32_t source = 0; source < source_count; source++)
        plane[source] = trimesh_root(plane, source);
    compact(&thin, target);
    mem_free(thin.gone);
    mem_free(thin.heads);
    mem_free(thin.tails);
    mem_free(thin.next);
}
