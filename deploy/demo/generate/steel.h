/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Structural steel and what people walk on. */
#ifndef GENERATE_STEEL_H
#define GENERATE_STEEL_H
#include "model.h"

/* An I-section from a to b, web standing towards `up`, of the given depth and flange width. */
void steel_beam(struct mesh *mesh, struct vec a, struct vec b, struct vec up, double depth, double width);
/* A column on a base plate. */
void steel_column(struct mesh *mesh, double x, double y, double z0, double z1, double depth);
/* Panels of grating with gaps between, top at z. */
void steel_floor(struct mesh *mesh, struct frame at, double x0, double x1, double y0, double y1, double z);
/* Posts, two rails and a toe plate along a polyline at foot level. */
void steel_handrail(struct mesh *mesh, const struct vec *points, int count);
/* Vertical, rungs along the frame's x, climber on its y side; caged from 2.3 m up. */
void steel_ladder(struct mesh *mesh, struct frame at, double height);
/* A straight flight; both points at its centre line. */
void steel_stair(struct mesh *steel, struct mesh *rail, struct vec foot, struct vec head, double width);
/* A ring platform between radii, with handrail outside, closed ends if it is not a full circle, and brackets below. */
void steel_ring_platform(struct mesh *steel, struct mesh *rail, struct frame at, double r0, double r1, double from_deg, double to_deg);

#endif
