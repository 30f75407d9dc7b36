/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Triangulation of one face (triangle of the surface) into which points and edges are inserted. It has points in the face's
 * plane, and triangles between them, all with the same orientation. */
#ifndef SURFACE_REPAIR_FACE_TRIANGULATION_H
#define SURFACE_REPAIR_FACE_TRIANGULATION_H
#include <stddef.h>
#include <stdint.h>

struct face_triangulation {
    uint32_t *ids; /* by point of the triangulation: index of this point in the mesh */
    double (*at)[2];
    uint32_t (*tris)[3]; /* corners of each triangle, as indices of the triangulation's points */
    size_t count, capacity, at_capacity, tri_count, tri_capacity;
};

/* Frees the triangulation. */
void face_triangulation_finish(struct face_triangulation *face);
/* Adds the mesh's point `id`, which is at (x, y) in the face's plane, to the triangulation. Returns the point's index in the triangulation;
 * no triangle uses the point yet. */
uint32_t face_triangulation_add_point(struct face_triangulation *face, uint32_t id, double x, double y);
/* Appends a triangle of three points to the triangulation. */
void face_triangulation_add_tri(struct face_triangulation *face, uint32_t a, uint32_t b, uint32_t c);
/* Splits the triangle that contains the point, or the two triangles at the edge that contains it. */
void face_triangulation_insert(struct face_triangulation *face, uint32_t point);
/* Makes the straight line from u to v an edge, or several edges if it passes over points, by flipping the edges that cross it. */
void face_triangulation_connect(struct face_triangulation *face, uint32_t u, uint32_t v);

#endif
