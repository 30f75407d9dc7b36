/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One triangle on the way to being cut up: points in its plane, and triangles between them, all turned the same way. */
#ifndef SURFACE_PIECE_H
#define SURFACE_PIECE_H
#include <stddef.h>
#include <stdint.h>

struct piece {
    uint32_t *ids; /* of its points, in the mesh */
    double (*at)[2];
    uint32_t (*tris)[3]; /* of its points */
    size_t count, capacity, at_capacity, tri_count, tri_capacity;
};

void piece_finish(struct piece *piece);
uint32_t piece_point(struct piece *piece, uint32_t id, double x, double y);
void piece_tri(struct piece *piece, uint32_t a, uint32_t b, uint32_t c);
/* Cuts the triangle that has the point in it, or the two beside the side that it is on. */
void piece_set_inside(struct piece *piece, uint32_t point);
/* Makes the straight way from u to v one side, or several over points that it passes over, by turning the sides that cross it. */
void piece_join(struct piece *piece, uint32_t u, uint32_t v);

#endif
