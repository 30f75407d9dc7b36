/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bridging what is broken, within one tolerance. */
#ifndef SURFACE_REPAIR_H
#define SURFACE_REPAIR_H
#include "surface/repair/parts.h"

/* What was joined: a place of the surface and the one that it became part of. Equal where edges cross a face. */
struct crack_bridge {
    double from_m[3], to_m[3];
};

struct repair_report {
    size_t bridges;
    struct crack_bridge *made; /* of all of them; mem_free. Grows from call to call */
    size_t made_count, made_capacity;
    double longest_m;
    int k;               /* neighbours asked of the point cloud; -1: out of memory */
    uint32_t *crossings; /* points where a part passes through itself; mem_free */
    size_t crossing_count, crossing_capacity;
};

/* Seams: points on open edges become one with other points on open edges (unwelded vertices), or are set into open edges (hanging vertices,
   hair gaps). The candidates come from the cloud of border points. Points closer to each other along an edge of theirs than 2.2 times the
   gap are left alone, so that nothing small collapses. target[point] (of mesh->point_count before): what it has become. */
void repair_seams(struct trimesh *mesh, double tolerance_m, uint32_t *target, struct repair_report *report);

/* Contacts between parts: where an edge passes through a face, also of its own part (parts->crossed, tangled), a point is set into both,
   and both are cut along the line where two faces cross;
   where a point lies within both parts' reach of another body's surface, or within the tolerance and both look at each other (sight.h), it
   is set into that; where the rim of a face that lies on another
   part crosses an edge there, a point is set into both edges. */
void repair_contacts(struct trimesh *mesh, struct parts *parts, uint32_t *target, struct repair_report *report);

/* Rims that are open because what else met there is hidden: where bodies that have vertices in common at some of the rim have a gap between
   them at the rest of it, the faces in between closed both, and what is outside would have to be reached through them. Closed as seams
   are, within both parts' reach. hidden: 0 or 1. Puts visible triangles first. Returns how many there are. */
size_t repair_rims(struct trimesh *mesh, const char *hidden, const struct parts *parts, uint32_t *target, struct repair_report *report);

#endif
