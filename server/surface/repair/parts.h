/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parts (bodies) that a surface consists of, as they were before anything was cut or joined. */
#ifndef SURFACE_REPAIR_PARTS_H
#define SURFACE_REPAIR_PARTS_H
#include "surface/mesh/trimesh.h"

/* A part is what hangs together by edges (a point in common is not enough: a corner may touch anything), a patch what does so by edges with
   two faces. Where one patch has two faces at an edge with more, the others only stand on it, like a fin: that does not make two closed
   bodies one part. */
struct body_parts {
    struct trimesh solid;
    uint32_t *of_tri;                     /* of the solid's triangles: part */
    signed char *side;                    /* likewise: +1 or -1, by which each patch faces the same way throughout; 0: it bounds nothing */
    uint32_t *of_source, *body_of_source; /* of the model's triangles: part; body, mostly the part */
    signed char *side_of_source;          /* likewise: side */
    char *closed;                         /* of each part: its open edges are short against its size */
    char *tangled;                        /* likewise: it has edges with three faces or more, or passes through itself */
    char *crossed;                        /* likewise: it passes through itself; set by repair_contacts */
    char *thin;                           /* likewise: it is closed, and its reach is less than the tolerance */
    double *reach_m;                      /* likewise: what is nearer touches it */
    double tolerance_m;                   /* the longest reach */
    double size_m;              /* diagonal of the main part; 0: of the solid. May be set after parts_init() */
    size_t count, source_count; /* parts; triangles of the model */
};

/* Finds the parts of `mesh`, the model's source_count triangles after welding and closing seams, with multiplicities. tolerance_m is every
   part's reach; if it was chosen by the program (is_chosen), a closed part's reach is at most half of its thickness, so that what touches
   one side of a plate does not touch the other; beyond that it is joined to what it faces (line_of_sight.h). Finish with parts_finish(). */
void parts_init(struct body_parts *parts, const struct trimesh *mesh, size_t source_count, double tolerance_m, bool is_chosen);
/* Frees the parts. */
void parts_finish(struct body_parts *parts);

/* Returns of_source looked up for each current triangle of the mesh. The caller frees it (mem_free). */
uint32_t *parts_spread(const struct trimesh *mesh, const uint32_t *of_source);

#endif
