/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Exact distances on polyhedra and the union of two closed ones, computed by CGAL. Slow; for tests only. */
#ifndef TESTS_ORACLE_GEODESIC_H
#define TESTS_ORACLE_GEODESIC_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct oracle_mesh { /* a mesh, for distances a manifold one; triangles: 3 vertex indices for each triangle */
    const float (*positions)[3];
    const uint32_t *triangles;
    size_t vertex_count, triangle_count;
};

/* Returns the index of the vertex whose coordinates equal p within 1e-5, or -1 if there is none. */
long oracle_vertex_at(const struct oracle_mesh *mesh, const float p[3]);

/* Computes distances from the point with these barycentric weights on a triangle to every vertex (Xin & Wang 2009). Returns
   false if the mesh is not a manifold or CGAL failed. */
bool oracle_distances(const struct oracle_mesh *mesh, size_t triangle, const double weights[3], double *distances);

/* Computes the outer surface of two closed meshes. The caller frees the result's positions and triangles with free(). */
bool oracle_union(const struct oracle_mesh *a, const struct oracle_mesh *b, struct oracle_mesh *result);

#ifdef __cplusplus
}
#endif
#endif
