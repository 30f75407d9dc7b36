/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds faces of a model that may cross other faces (crossing_faces.h), by testing pairs. Two faces do not cross if the plane
   of one face separates them. Neither do they cross if the segment in which one face cuts the other's plane is outside one side
   of that other face. */
#include "surface/repair/crossing_faces.h"

#include "base/math/vec.h"
#include "base/mem.h"
#include "surface/mesh/bvh.h"

/* allowance for rounding errors of positions, relative to the largest coordinate */
#define ROUNDING 1e-10
/* a face whose height above its longest side is smaller than this, relative to the model's size, is a sliver: its computed
   plane is not reliable */
#define SLIVER 1e-5
#define BESIDE 1e-4 /* allowance for rounding errors in the intersection of a face with a plane, relative to the face's longest side */

struct crossing_face {
    const double *at[3];
    double normal[3], height_m, longest_m; /* normal: unit vector */
};

struct crossing_search {
    const struct body_parts *parts;
    double rounding_m, sliver_m;
    uint32_t tri;              /* the face being tested */
    struct crossing_face face; /* geometry of `tri` */
    bool crosses;
};

static void face_init(struct crossing_face *face, const struct trimesh *mesh, uint32_t tri)
{
    for (int i = 0; i < 3; i++)
        face->at[i] = mesh->points[mesh->tris[tri][i]];
    vec_normal(face->at[0], face->at[1], face->at[2], face->normal);
    face->longest_m = 0;
    for (int i = 0; i < 3; i++)
        face->longest_m = max_of(face->longest_m, vec_distance(face->at[i], face->at[(i + 1) % 3]));
    double doubled_m2 = vec_normalize(face->normal);
    face->height_m = face->longest_m > 0 ? doubled_m2 / face->longest_m : 0;
}

/* Computes the heights of a face's corners above another face's plane. Returns true if all corners are on one side of the plane, or no
 * farther than clear_m on the other side. */
static bool lies_to_one_side(const struct crossing_face *plane, const struct crossing_face *face, double clear_m, double heights_m[3])
{
    double low_m = INFINITY, high_m = -INFINITY;
    for (int i = 0; i < 3; i++) {
        double from[3];
        vec_sub(face->at[i], plane->at[0], from);
        heights_m[i] = vec_dot(from, plane->normal);
        low_m = min_of(low_m, heights_m[i]);
        high_m = max_of(high_m, heights_m[i]);
    }
    return high_m <= clear_m || low_m >= -clear_m;
}

/* Returns how far a point in a face's plane is outside the face's side from corner i to the next; negative: the point is inside
 * that side. */
static double beyond_side(const struct crossing_face *face, int i, const double place[3])
{
    double along[3], out[3], from[3];
    vec_sub(face->at[(i + 1) % 3], face->at[i], along);
    vec_cross(along, face->normal, out);
    vec_normalize(out);
    vec_sub(place, face->at[i], from);
    return vec_dot(from, out);
}

/* Returns whether a face lies entirely on one side of the line from a to b, at least margin_m away from it. The line is in the
 * face's plane. */
static bool lies_beside(const struct crossing_face *face, const double a[3], const double b[3], double margin_m)
{
    double along[3], across[3], low_m = INFINITY, high_m = -INFINITY;
    vec_sub(b, a, along);
    vec_cross(along, face->normal, across);
    vec_normalize(across);
    for (int i = 0; i < 3; i++) {
        double from[3];
        vec_sub(face->at[i], a, from);
        low_m = min_of(low_m, vec_dot(from, across));
        high_m = max_of(high_m, vec_dot(from, across));
    }
    return low_m > margin_m || high_m < -margin_m;
}

/* Returns the index (0 to 2) of the face's corner that is also a corner of the other face; -1: none. */
static int shared_corner(const struct crossing_face *face, const struct crossing_face *other)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (face->at[i] == other->at[j])
                return i;
    return -1;
}

/* Returns whether the line segment in which a face intersects the plane of `other` stays clear of `other`, except at a corner
 * of both faces. heights_m: heights of the face's corners above that plane. */
static bool cuts_beside(const struct crossing_face *face, const double heights_m[3], const struct crossing_face *other, double margin_m)
{
    const int shared = shared_corner(face, other), from = shared_corner(other, face);
    double ends[2][3];
    int count = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3;
        if ((heights_m[i] >= 0) == (heights_m[j] >= 0) || i == shared || j == shared)
            continue;
        vec_mix(face->at[i], face->at[j], heights_m[i] / (heights_m[i] - heights_m[j]), ends[count++]);
    }
    for (int i = 0; i < 3; i++) {
        /* if the faces share a corner, test only the two sides of `other` at that corner */
        bool beyond = count > 0 && (from < 0 || i == from || (i + 1) % 3 == from);
        for (int end = 0; end < count; end++)
            beyond = beyond && beyond_side(other, i, ends[end]) > margin_m;
        if (beyond)
            return true;
    }
    return shared < 0 && count == 2 && lies_beside(other, ends[0], ends[1], margin_m);
}

static void visit_face(void *arg, uint32_t tri)
{
    struct crossing_search *s = arg;
    const struct body_parts *parts = s->parts;
    const uint32_t own = parts->of_source[parts->solid.tri_source[s->tri]], part = parts->of_source[parts->solid.tri_source[tri]];
    struct crossing_face other;
    double heights_m[3], others_m[3], clear_m = own == part ? CROSSING_CLEAR / 2 * parts->reach_m[own] : 0;
    if (s->crosses || tri == s->tri)
        return;
    face_init(&other, &parts->solid, tri);
    if (s->face.height_m < s->sliver_m || other.height_m < s->sliver_m) {
        s->crosses = true;
        return;
    }
    bool clear = clear_m > 4 * s->rounding_m;
    if (lies_to_one_side(&other, &s->face, clear ? clear_m : -s->rounding_m, heights_m))
        return;
    s->crosses = clear ? !cuts_beside(&s->face, heights_m, &other, BESIDE * s->face.longest_m + s->rounding_m)
                       : !lies_to_one_side(&s->face, &other, -s->rounding_m, others_m);
}

char *crossing_faces_find(const struct body_parts *parts)
{
    const struct trimesh *mesh = &parts->solid;
    struct crossing_search search = { .parts = parts };
    struct bvh *bvh = bvh_create(mesh);
    double low[3], high[3], size_m = 0, coordinate_m = 0;
    bool any = false;
    for (int axis = 0; axis < 3; axis++) {
        double least_m = INFINITY, most_m = -INFINITY;
        for (size_t p = 0; p < mesh->point_count; p++) {
            least_m = min_of(least_m, mesh->points[p][axis]);
            most_m = max_of(most_m, mesh->points[p][axis]);
        }
        size_m = max_of(size_m, most_m - least_m);
        coordinate_m = max_of(coordinate_m, max_of(most_m, -least_m));
    }
    search.rounding_m = ROUNDING * coordinate_m;
    search.sliver_m = SLIVER * (parts->size_m > 0 ? parts->size_m : size_m);
    char *crosses = mem_array(parts->source_count, 1);
    for (uint32_t t = 0; t < mesh->tri_count; t++) {
        if (crosses[mesh->tri_source[t]])
            continue;
        search.tri = t;
        search.crosses = false;
        face_init(&search.face, mesh, t);
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = min_of(min_of(search.face.at[0][axis], search.face.at[1][axis]), search.face.at[2][axis]);
            high[axis] = max_of(max_of(search.face.at[0][axis], search.face.at[1][axis]), search.face.at[2][axis]);
        }
        bvh_overlaps(bvh, low, high, search.rounding_m, visit_face, &search);
        crosses[mesh->tri_source[t]] = search.crosses;
        any = any || search.crosses;
    }
    bvh_destroy(&bvh);
    if (!any)
        mem_free(crosses);
    return any ? crosses : NULL;
}
