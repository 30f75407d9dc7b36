/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One triangle on the way to being cut up: points in its plane, and triangles between them, all turned the same way. */
#ifndef SURFACE_REPAIR_FACE_TRIANGULATION_H
#define SURFACE_REPAIR_FACE_TRIANGULATION_H
#include <stddef.h>
#include <stdint.h>

struct face_triangulation {
    uint32_t *ids; /* of its points, in the mesh */
    double (*at)[2];
    uint32_t (*tris)[3]; /* of its points */
    size_t count, capacity, at_capacity, tri_count, tri_capacity;
};

void face_triangulation_finish(struct face_triangulation *face);
uint32_t face_triangulation_add_point(struct face_triangulation *face, uint32_t id, double x, double y);
void face_triangulation_add_tri(struct face_triangulation *face, uint32_t a, uint32_t b, uint32_t c);
/* Cuts the triangle that has the point in it, or the two beside the side that it is on. */
void face_triangulation_insert(struct face_triangulation *face, uint32_t point);
/* Makes the straight way from u to v one side, or several over points that it passes over, by turning the sides that cross it. */
void face_triangulation_connect(struct face_triangulation *face, uint32_t u, uint32_t v);

#endif
