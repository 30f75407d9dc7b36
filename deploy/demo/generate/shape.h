/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solids out of which equipment is made. Angles in degrees, lengths in metres; `step` is the longest edge along a straight
   length (0: as long as it is), because the field is carried by vertices. */
#ifndef GENERATE_SHAPE_H
#define GENERATE_SHAPE_H
#include "mesh.h"

#define PROFILE_MAX 160

struct profile { /* what is turned on the lathe: from the bottom up along the outside; zero-initialise */
    struct profile_point {
        double r, z;
        bool smooth; /* no hard edge here */
    } points[PROFILE_MAX];
    int count;
};
void profile_edge(struct profile *profile, double r, double z);
void profile_smooth(struct profile *profile, double r, double z);
/* Dished ends with tangents that meet the cylinder: from the pole at z - height to (r, z), or from (r, z) to the pole at z + height. */
void profile_bowl(struct profile *profile, double r, double z, double height, int pieces);
void profile_dome(struct profile *profile, double r, double z, double height, int pieces);
/* A straight length from z0 to z1 in sheets of about `sheet`, each lapping over the next by a few millimetres. */
void profile_laps(struct profile *profile, double r, double z0, double z1, double sheet);

void shape_revolve(struct mesh *mesh, struct frame at, const struct profile *profile, int sides, double step);
/* From the origin along z. Ends are closed by fans from one rim vertex, as CAD kernels do: long thin triangles. */
void shape_cylinder(struct mesh *mesh, struct frame at, double r, double length, int sides, double step);
void shape_tube(struct mesh *mesh, struct frame at, double r0, double r1, double length, int sides,
                double step); /* open; cone if r0 != r1 */
/* Between circles that are not coaxial: the second lies at (shift, 0, length). */
void shape_reducer(struct mesh *mesh, struct frame at, double r0, double r1, double shift, double length, int sides, double step);
/* Part of a torus about the frame's z. */
void shape_torus(struct mesh *mesh, struct frame at, double radius, double r, double from_deg, double to_deg, int rings, int sides);
void shape_block(struct mesh *mesh, struct frame at, double x0, double x1, double y0, double y1, double z0, double z1);
/* A block bent around the frame's z. */
void shape_sector(struct mesh *mesh, struct frame at, double r0, double r1, double z0, double z1, double from_deg, double to_deg,
                  int pieces);
/* A strap around a cylinder of radius r, laid slanting: one edge under the surface, the other 8 mm above it. */
void shape_band(struct mesh *mesh, struct frame at, double r, double width, int sides);
void shape_bar(struct mesh *mesh, struct vec a, struct vec b, double r, int sides); /* open ends */
/* A convex outline (counter-clockwise, x and y) from z0 to z1, hard edges. */
void shape_prism(struct mesh *mesh, struct frame at, const double (*outline)[2], int count, double z0, double z1);
void shape_hexagon(struct mesh *mesh, struct frame at, double r, double z0, double z1);

struct station { /* a cross-section of a swept tube */
    struct vec centre, tangent;
};
void shape_sweep(struct mesh *mesh, const struct station *stations, int count, double r, int sides);

#endif
