/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mesh repair: bridges cracks and contacts within one tolerance, in three steps (seams, contacts between parts, rims). */
#ifndef SURFACE_REPAIR_H
#define SURFACE_REPAIR_H
#include "surface/repair/parts.h"

/* A bridge that was made: a place of the surface, and the place that it was joined to; equal where edges cross a face. */
struct crack_bridge {
    double from_m[3], to_m[3];
};

/* What was repaired; it grows from call to call. */
struct repair_report {
    size_t bridges;
    struct crack_bridge *made; /* of all of them; mem_free. Grows from call to call */
    size_t made_count, made_capacity;
    double longest_m;
    int k;               /* neighbours asked of the point cloud; -1: out of memory */
    uint32_t *crossings; /* points where a part passes through itself; mem_free */
    size_t crossing_count, crossing_capacity;
};

/* Closes seams: merges points on border edges with others on border edges (unwelded vertices), or inserts them into border edges (hanging
   vertices, hair gaps). Candidates come from the point cloud of border points. Points closer to each other along an edge than 2.2 times the
   gap are left alone, so that nothing small collapses. target[point], of the points before: receives what it has become. */
void repair_seams(struct trimesh *mesh, double tolerance_m, uint32_t *target, struct repair_report *report);

/* Only merges points on border edges with others on border edges, as one round of repair_seams(), but none where faces that lie on each
   other would be joined. target: as repair_seams(). */
void repair_join_points(struct trimesh *mesh, double tolerance_m, uint32_t *target, struct repair_report *report);

/* Joins parts in contact: where an edge passes through a face (also of its own part, parts->crossed), a point is inserted into both, and
   both are cut along the line where two faces cross; where a point lies within both parts' reach of another body, or within the tolerance
   and both face each other (line_of_sight.h), it is inserted there; where the rim of a face that lies on another part crosses an edge, a
   point is inserted into both. target: as repair_seams(). */
void repair_contacts(struct trimesh *mesh, struct body_parts *parts, uint32_t *target, struct repair_report *report);

/* Closes rims that are open because what met there is hidden: where bodies with common vertices along part of a rim have a gap along the
   rest, the hidden faces in between had closed both. Closed as seams are, within both parts' reach. hidden[tri]: 0 or 1. Puts visible
   triangles first. Returns how many there are. target: as repair_seams(). */
size_t repair_rims(struct trimesh *mesh, const char *hidden, const struct body_parts *parts, uint32_t *target,
                   struct repair_report *report);

#endif
