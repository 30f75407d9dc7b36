/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mesh repair: bridges cracks and contacts within one tolerance, in three steps (seams, contacts between parts, rims). */
#ifndef SURFACE_REPAIR_H
#define SURFACE_REPAIR_H
#include "surface/repair/parts.h"

/* A bridge: a surface point and the point that it was joined to; both are equal where an edge crosses a face. */
struct crack_bridge {
    double from_m[3], to_m[3];
};

/* Results of the repair; accumulated over several calls. */
struct repair_report {
    size_t bridges;
    struct crack_bridge *made; /* all bridges; free with mem_free */
    size_t made_count, made_capacity;
    double longest_m;
    int k;               /* count of neighbours requested per point (point_cloud.h); -1: out of memory */
    uint32_t *crossings; /* points where a part intersects itself; free with mem_free */
    size_t crossing_count, crossing_capacity;
};

/* Closes seams: merges points on border edges with other border points (unwelded vertices), or inserts them into border edges (hanging
 * vertices, hair gaps). Candidates come from the point cloud of border points. Points with an edge shorter than 2.2 times the gap are left
 * alone, so that no small feature collapses. target[point]: receives the new index of each previous point. */
void repair_seams(struct trimesh *mesh, double tolerance_m, uint32_t *target, struct repair_report *report);

/* Only merges border points with border points, as one round of repair_seams() does, but not where this would join faces that lie on each
   other. target: as in repair_seams(). */
void repair_join_points(struct trimesh *mesh, double tolerance_m, uint32_t *target, struct repair_report *report);

/* Joins parts in contact. Where an edge passes through a face (also of its own part, parts->crossed), a point is inserted into both, and
   both faces are cut along their intersection. Where a point is within both parts' reach of another body, or within the tolerance and both
   face each other (line_of_sight.h), the point is inserted there. Where the rim of a face that lies on another part crosses an edge, a
   point is inserted into both. target: as in repair_seams(). */
void repair_contacts(struct trimesh *mesh, struct body_parts *parts, uint32_t *target, struct repair_report *report);

/* Closes rims: edges that are open only because the triangles beyond them are hidden. Where two bodies share vertices along a part of a rim
 * and have a gap along the rest, hidden faces had closed the gap. Closes rims like seams, within both parts' reach. hidden[tri]: 0 or 1.
 * Moves visible triangles to the front of the mesh. Returns the number of visible triangles. target: as in repair_seams(). */
size_t repair_rims(struct trimesh *mesh, const char *hidden, const struct body_parts *parts, uint32_t *target,
                   struct repair_report *report);

#endif
