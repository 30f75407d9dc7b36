/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Normals for triangles that come without: angle-weighted, with creases. */
#include "preprocess/geometry/normals.h"

#include <math.h>
#include <meshoptimizer.h>
#include <string.h>

#include "base/mem.h"
#include "base/vec.h"

#define CREASE_COSINE 0.766 /* of 40 degrees: a cylinder of ten sides is round, one of eight has edges */

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

struct around {      /* which corners meet at a place */
    unsigned *place; /* of each vertex: the first vertex at the same place */
    uint32_t *first, *corners;
    double (*faces)[3];
    double *angles; /* of each corner */
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

static void corner_normal(const struct around *a, uint32_t corner, unsigned place, float out[3])
{
    const double *own = a->faces[corner / 3];
    double sum[3] = { 0 };
    for (uint32_t i = a->first[place]; i < a->first[place + 1]; i++) {
        const double *face = a->faces[a->corners[i] / 3];
        if (vec_dot(own, face) < CREASE_COSINE)
            continue;
        for (int axis = 0; axis < 3; axis++)
            sum[axis] += a->angles[a->corners[i]] * face[axis];
    }
    if (!(vec_normalize(sum) > 0))
        memcpy(sum, vec_dot(own, own) > 0 ? own : (const double[3]){ 0, 0, 1 }, sizeof(sum));
    for (int axis = 0; axis < 3; axis++)
        out[axis] = (float)sum[axis];
}

bool normals_compute(const float (*positions)[3], size_t vertex_count, const uint32_t *indices, size_t index_count,
                     float (*corner_normals)[3])
{
    struct around around;
    bool good = around_init(&around, positions, vertex_count, indices, index_count);
    for (uint32_t i = 0; good && i < index_count; i++)
        corner_normal(&around, i, around.place[indices[i]], corner_normals[i]);
    around_finish(&around);
    return good;
}
