/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes angle-weighted normals with creases. */
#include "preprocess/geometry/normals.h"

#include <math.h>
#include <meshoptimizer.h>
#include <stdlib.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"

/* number of faces at one position up to which all pairs of face normals are compared; above it, a tree is searched (normals_half) */
#define MANY 256
#define LEAF 16
/* cosine of the crease angle, 40 degrees; the normals of neighbouring faces at a smaller angle are averaged: a cylinder with
 * ten sides looks round, one with eight sides shows its edges */
#define CREASE_COSINE 0.766

static void face_normal(const float a[3], const float b[3], const float c[3], double out[3])
{
    vecf_normal(a, b, c, out);
    if (!(vec_normalize(out) > 0))
        memcpy(out, (const double[3]){ 0, 0, 0 }, 3 * sizeof(*out));
}

static double corner_angle(const float at[3], const float b[3], const float c[3])
{
    double ab[3], ac[3];
    vecf_sub(b, at, ab);
    vecf_sub(c, at, ac);
    if (!(vec_normalize(ab) > 0) || !(vec_normalize(ac) > 0))
        return 0;
    return acos(fmin(fmax(vec_dot(ab, ac), -1), 1));
}

struct around {      /* for each position: the corners of all triangles that meet there */
    unsigned *place; /* by vertex: lowest index of a vertex at the same position */
    uint32_t *first, *corners;
    double (*faces)[3];
    double *angles; /* by triangle corner: the triangle's angle there */
};

static void around_finish(struct around *a)
{
    mem_free(a->place);
    mem_free(a->first);
    mem_free(a->corners);
    mem_free(a->faces);
    mem_free(a->angles);
}

static bool around_init(struct around *a, const float (*positions)[3], size_t vertex_count, const uint32_t *indices, size_t index_count)
{
    *a = (struct around){ .place = mem_try_array(vertex_count, sizeof(*a->place)),
                          .first = mem_try_array(vertex_count + 2, sizeof(*a->first)),
                          .corners = mem_try_array(index_count, sizeof(*a->corners)),
                          .faces = mem_try_array(index_count / 3, sizeof(*a->faces)),
                          .angles = mem_try_array(index_count, sizeof(*a->angles)) };
    if (!a->place || !a->first || !a->corners || !a->faces || !a->angles)
        return false;
    meshopt_generateVertexRemap(a->place, NULL, vertex_count, positions, vertex_count, sizeof(*positions));
    for (size_t i = 0; i < index_count; i++) {
        size_t t = i / 3 * 3;
        const uint32_t next = indices[t + (i + 1) % 3], last = indices[t + (i + 2) % 3];
        a->first[a->place[indices[i]] + 2]++;
        a->angles[i] = corner_angle(positions[indices[i]], positions[next], positions[last]);
        if (i == t)
            face_normal(positions[indices[t]], positions[indices[t + 1]], positions[indices[t + 2]], a->faces[t / 3]);
    }
    for (size_t i = 2; i < vertex_count + 2; i++)
        a->first[i] += a->first[i - 1];
    for (uint32_t i = 0; i < index_count; i++)
        a->corners[a->first[a->place[indices[i]] + 1]++] = i;
    return true;
}

/* --- computing the mean normal of the faces at one position ------------------------------------------------------------------ */

/* Adds the normal of the face at `corner` to the sum, weighted by the face's angle at that corner. Skips the face if its normal
   is more than the crease angle from `own`, the normal of the face for which the sum is computed. */
static void add_face(const struct around *a, uint32_t corner, const double own[3], double sum[3])
{
    const double *face = a->faces[corner / 3];
    if (vec_dot(own, face) < CREASE_COSINE)
        return;
    for (int axis = 0; axis < 3; axis++)
        sum[axis] += a->angles[corner] * face[axis];
}

/* Writes the normalised sum of the face normals, or the face's own normal if the sum is zero. */
static void take_direction(double sum[3], const double own[3], float out[3])
{
    if (!(vec_normalize(sum) > 0))
        memcpy(sum, vec_dot(own, own) > 0 ? own : (const double[3]){ 0, 0, 1 }, 3 * sizeof(*sum));
    for (int axis = 0; axis < 3; axis++)
        out[axis] = (float)sum[axis];
}

/* Node of a binary tree over the normals of the faces at one position, used where very many faces meet. Each node's normals are
 * split in half between its children. A node wholly inside or outside the crease angle is added or skipped without visiting its
 * children. Nodes are stored as in a binary heap. */
struct normals_half {
    double low[3], high[3], sum[3]; /* bounding box of the node's normals, and their angle-weighted sum */
};

struct halves {
    const struct around *around;
    uint32_t *corners; /* triangle corners at the position, ordered so that each tree node has a contiguous range */
    struct normals_half *nodes;
};

static int compare_axis(const void *pa, const void *pb, void *arg)
{
    const struct halves *halves = ((void **)arg)[0];
    int axis = *(const int *)((void **)arg)[1];
    double a = halves->around->faces[*(const uint32_t *)pa / 3][axis], b = halves->around->faces[*(const uint32_t *)pb / 3][axis];
    return (a > b) - (a < b);
}

static void halves_build(struct halves *halves, size_t node, size_t begin, size_t end)
{
    struct normals_half *half = &halves->nodes[node];
    *half = (struct normals_half){ .low = { 2, 2, 2 }, .high = { -2, -2, -2 } };
    for (size_t i = begin; i < end; i++) {
        const double *face = halves->around->faces[halves->corners[i] / 3];
        for (int axis = 0; axis < 3; axis++) {
            half->low[axis] = fmin(half->low[axis], face[axis]);
            half->high[axis] = fmax(half->high[axis], face[axis]);
            half->sum[axis] += halves->around->angles[halves->corners[i]] * face[axis];
        }
    }
    if (end - begin <= LEAF)
        return;
    int axis = 0;
    for (int other = 1; other < 3; other++)
        if (half->high[other] - half->low[other] > half->high[axis] - half->low[axis])
            axis = other;
    if (half->high[axis] > half->low[axis])
        qsort_r(halves->corners + begin, end - begin, sizeof(*halves->corners), compare_axis, (void *[2]){ halves, &axis });
    size_t middle = begin + (end - begin) / 2;
    halves_build(halves, 2 * node + 1, begin, middle);
    halves_build(halves, 2 * node + 2, middle, end);
}

static void halves_sum(const struct halves *halves, size_t node, size_t begin, size_t end, const double own[3], double sum[3])
{
    const struct normals_half *half = &halves->nodes[node];
    double nearest[3], farthest[3];
    for (int axis = 0; axis < 3; axis++) {
        nearest[axis] = own[axis] > 0 ? half->high[axis] : half->low[axis];
        farthest[axis] = own[axis] > 0 ? half->low[axis] : half->high[axis];
    }
    if (vec_dot(own, nearest) < CREASE_COSINE)
        return;
    if (vec_dot(own, farthest) >= CREASE_COSINE) {
        for (int axis = 0; axis < 3; axis++)
            sum[axis] += half->sum[axis];
        return;
    }
    size_t middle = begin + (end - begin) / 2;
    if (end - begin > LEAF) {
        halves_sum(halves, 2 * node + 1, begin, middle, own, sum);
        halves_sum(halves, 2 * node + 2, middle, end, own, sum);
        return;
    }
    for (size_t i = begin; i < end; i++)
        add_face(halves->around, halves->corners[i], own, sum);
}

static bool sum_of_many(const struct around *a, uint32_t first, size_t count, float (*corner_normals)[3])
{
    /* the two children of a node differ by at most one normal, so node indices stay below twice the smallest power of 2 above
     * count / LEAF */
    size_t node_count = 4;
    while (node_count < 4 * (count / LEAF + 1))
        node_count *= 2;
    struct halves halves = { a, mem_try_array(count, sizeof(*halves.corners)), mem_try_array(node_count, sizeof(*halves.nodes)) };
    bool good = halves.corners && halves.nodes;
    if (good) {
        memcpy(halves.corners, a->corners + first, count * sizeof(*halves.corners));
        halves_build(&halves, 0, 0, count);
    }
    for (size_t i = 0; good && i < count; i++) {
        uint32_t corner = halves.corners[i];
        double sum[3] = { 0 };
        halves_sum(&halves, 0, 0, count, a->faces[corner / 3], sum);
        take_direction(sum, a->faces[corner / 3], corner_normals[corner]);
    }
    mem_free(halves.corners);
    mem_free(halves.nodes);
    return good;
}

static void sum_of_few(const struct around *a, uint32_t first, size_t count, float (*corner_normals)[3])
{
    for (size_t i = first; i < first + count; i++) {
        const double *own = a->faces[a->corners[i] / 3];
        double sum[3] = { 0 };
        for (size_t other = first; other < first + count; other++)
            add_face(a, a->corners[other], own, sum);
        take_direction(sum, own, corner_normals[a->corners[i]]);
    }
}

bool normals_compute(const float (*positions)[3], size_t vertex_count, const uint32_t *indices, size_t index_count,
                     float (*corner_normals)[3])
{
    struct around around;
    bool good = around_init(&around, positions, vertex_count, indices, index_count);
    for (size_t place = 0; good && place < vertex_count; place++) {
        size_t count = around.first[place + 1] - around.first[place];
        if (count > MANY)
            good = sum_of_many(&around, around.first[place], count, corner_normals);
        else
            sum_of_few(&around, around.first[place], count, corner_normals);
    }
    around_finish(&around);
    return good;
}
