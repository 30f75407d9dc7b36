/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parts of a surface, in their state before surface sampling and repair. */
#ifndef SURFACE_REPAIR_PARTS_H
#define SURFACE_REPAIR_PARTS_H
#include "surface/mesh/trimesh.h"

/* A part is a set of triangles connected by edges (sharing a point is not enough). A patch is a set of triangles connected by edges with
   exactly two faces. An edge may have more faces, two of which belong to one patch. The other faces then only stand on that patch, like a
   fin. Such an edge does not make two closed bodies one part. */
struct body_parts {
    struct trimesh solid;
    uint32_t *of_tri; /* [triangle of `solid`]: index of the part to which the triangle belongs */
    /* by triangle of `solid`: 1 if its winding faces outwards, -1 if reversed. 0: the triangle bounds nothing: it is a wall
     * between two bodies, or a fin (a sheet that stands on a body) */
    signed char *side;
    /* by model triangle: number of its part, and number of its body. Part and body differ only where an error in the model
       joins two bodies into one part by a few edges */
    uint32_t *of_source, *body_of_source;
    signed char *side_of_source; /* per model triangle: side */
    char *closed;                /* by part: 1 if it is closed, which means that its open edges are short compared with its size */
    char *tangled;               /* by part: 1 if it has edges with three faces or more, or intersects itself */
    char *crossed;               /* by part: 1 if it intersects itself; set by repair_contacts() */
    /* by part: 1 if it is closed and so thin that its reach (distance up to which it counts as touching) is below the tolerance */
    char *thin;
    double *reach_m;    /* by part: distance up to which another surface counts as touching it */
    double tolerance_m; /* largest reach of a part */
    /* length in metres of the diagonal of the surface's main part (base/math/gap_split.h); 0: the diagonal of `solid` is used.
       May be set after parts_init() */
    double size_m;
    size_t count, source_count; /* count: parts; source_count: model triangles */
};

/* Finds the parts of `mesh`: the model's source_count triangles after welding and closing seams. tri_times must be the number
 * of model triangles in each of its triangles. Every part's reach (distance up to which it counts as touching) is tolerance_m.
 * If the program chose the tolerance (is_chosen), a closed part's reach is at most half of its thickness. Then a surface that
 * touches one side of a plate does not touch the other side. Surfaces beyond the reach are joined if the part faces them
 * (line_of_sight.h). Free with parts_finish(). */
void parts_init(struct body_parts *parts, const struct trimesh *mesh, size_t source_count, double tolerance_m, bool is_chosen);
/* Frees the parts. */
void parts_finish(struct body_parts *parts);

/* Returns an array with a number (such as that of its part or body) for each triangle of the mesh, taken from of_source[model triangle].
   The caller frees the array (mem_free). */
uint32_t *parts_spread(const struct trimesh *mesh, const uint32_t *of_source);

#endif
