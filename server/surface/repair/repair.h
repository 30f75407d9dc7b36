/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mesh repair: bridges cracks and joins parts in contact, up to a tolerance. It has three steps: seams, contacts between parts,
 * and rims (edges that are open because the triangles beyond them are hidden). */
#ifndef SURFACE_REPAIR_H
#define SURFACE_REPAIR_H
#include "surface/repair/parts.h"

/* bridge across a crack: a point of the surface, and the position of the point joined to it; both are equal where an edge crosses a face */
struct crack_bridge {
    double from_m[3], to_m[3];
};

/* counts and lengths of the changes that mesh repair has made, summed over several calls */
struct repair_report {
    size_t bridges;
    struct crack_bridge *made; /* all bridges; free with mem_free */
    size_t made_count, made_capacity;
    double longest_m;
    /* largest number of neighbours per point that the search for gaps between faces requested (point_cloud.h); -1: out of
       memory */
    int k;
    uint32_t *crossings; /* indices of points where a part intersects itself; free with mem_free */
    size_t crossing_count, crossing_capacity;
};

/* Closes seams. Merges points on border edges (edges with one face) with other border points, which closes gaps between unwelded vertices.
 * Inserts them into border edges, which removes hanging vertices and closes hair gaps. Pairs of points within the tolerance come from
 * point_cloud.h. Points with an edge shorter than 2.2 times the gap are left alone, so that no small feature collapses. target[point]
 * receives the point's new index. */
void repair_seams(struct trimesh *mesh, double tolerance_m, uint32_t *target, struct repair_report *report);

/* Merges points on border edges (edges with one face) within tolerance_m of each other. Leaves out points whose merging would
 * join two faces that lie on each other. Unlike repair_seams(), inserts no points into edges. target[point] receives the
 * point's new index. */
void repair_join_points(struct trimesh *mesh, double tolerance_m, uint32_t *target, struct repair_report *report);

/* Joins parts in contact. Where an edge passes through a face, also one of its own part (recorded in parts->crossed), a point
 * is inserted into both. Both faces are cut along their intersection. A point is inserted into another body within both parts'
 * reach (distance up to which they count as touching). It is also inserted within the tolerance if both face each other
 * (line_of_sight.h). Where the rim of a face that lies on another part crosses an edge of that part, a point is inserted into
 * both edges. target: as in repair_seams(). */
void repair_contacts(struct trimesh *mesh, struct body_parts *parts, uint32_t *target, struct repair_report *report);

/* Closes rims: edges that are open only because the triangles beyond them are hidden. Two bodies may share vertices along one stretch of a
 * rim and have a gap along another; hidden faces had closed this gap. Rims are closed like seams, within both parts' reach (distance up to
 * which they count as touching). hidden[tri]: 1 if the triangle is hidden, else 0. Moves visible triangles to the front of the mesh.
 * Returns the number of visible triangles. target: as in repair_seams(). */
size_t repair_rims(struct trimesh *mesh, const char *hidden, const struct body_parts *parts, uint32_t *target,
                   struct repair_report *report);

#endif
