/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parts (bodies) of a surface, in their state before sampling and repair. */
#ifndef SURFACE_REPAIR_PARTS_H
#define SURFACE_REPAIR_PARTS_H
#include "surface/mesh/trimesh.h"

/* A part is a set of triangles connected by edges (sharing a point is not enough), a patch a set connected by edges with two faces. Where
   an edge has more faces and one patch has two of these faces, the other faces only stand on that patch, like a fin. This does not make two
   closed bodies one part. */
struct body_parts {
    struct trimesh solid;
    uint32_t *of_tri; /* part of each triangle of `solid` */
    /* orientation of each triangle of `solid`: +1 or -1 makes each patch face outwards; 0: the triangle bounds nothing */
    signed char *side;
    uint32_t *of_source, *body_of_source; /* part and body of each model triangle; usually equal */
    signed char *side_of_source;          /* per model triangle: side */
    char *closed;                         /* 1 for parts that are closed: their open edges are short compared with their size */
    char *tangled;                        /* by part: 1 if it has edges with three faces or more, or intersects itself */
    char *crossed;                        /* 1 for parts that intersect themselves; set by repair_contacts() */
    char *thin;                           /* 1 for parts that are closed and have a reach below the tolerance */
    double *reach_m;                      /* reach of each part: other surfaces nearer than this count as touching it */
    double tolerance_m;                   /* largest reach of a part */
    double size_m;                        /* diagonal of the main part; 0: of `solid`. May be set after parts_init() */
    size_t count, source_count;           /* count: parts; source_count: model triangles */
};

/* Finds the parts of `mesh`: the model's source_count triangles after welding and closing seams, with multiplicities. Every part's reach is
   tolerance_m. If the program chose the tolerance (is_chosen), a closed part's reach is at most half of its thickness, so that a surface
   that touches one side of a plate does not touch the other; farther surfaces are joined if the part faces them (line_of_sight.h). Free
   with parts_finish(). */
void parts_init(struct body_parts *parts, const struct trimesh *mesh, size_t source_count, double tolerance_m, bool is_chosen);
/* Frees the parts. */
void parts_finish(struct body_parts *parts);

/* Returns of_source for each current triangle of the mesh. The caller frees it (mem_free). */
uint32_t *parts_spread(const struct trimesh *mesh, const uint32_t *of_source);

#endif
