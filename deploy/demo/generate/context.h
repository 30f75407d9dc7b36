/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What carries and surrounds the equipment. Coordinates in the plant frame. */
#ifndef GENERATE_CONTEXT_H
#define GENERATE_CONTEXT_H
#include "equipment.h"

#define GRADE_WEST_M -21.0
#define GRADE_EAST_M 21.0
#define GRADE_SOUTH_M -13.0
#define GRADE_NORTH_M 13.0

/* Slab with joints, kerbs, gravel, walkway marks. Opens site->civil; the caller ends it. */
void civil_build(struct site *site);
/* A kerbed rectangle, for example around pumps or a tank. */
void civil_kerb(struct site *site, double x0, double x1, double y0, double y1, double height);
/* The pipe rack along x: bents, two pipe levels, cable trays, bracing, fireproofed feet. */
void rack_build(struct site *site, const char *name);
#define RACK_SOUTH_M 7.0
#define RACK_NORTH_M 12.0
#define RACK_LOW_M 4.3   /* top of steel of the pipe levels */
#define RACK_HIGH_M 6.2
#define RACK_TOP_M 7.9
#define RACK_BENT_COUNT 7
#define RACK_BENT_M 6.0
/* The two-storey structure of the overhead system: floors, stairs, ladder. */
void structure_build(struct site *site, const char *name);
#define STRUCTURE_WEST_M -3.4
#define STRUCTURE_EAST_M 5.0
#define STRUCTURE_SOUTH_M 0.4
#define STRUCTURE_NORTH_M 5.6
#define STRUCTURE_LOW_M 3.8
#define STRUCTURE_HIGH_M 7.3

#endif
