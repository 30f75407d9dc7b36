/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parts that pumps, fans and the compressor share. */
#ifndef GENERATE_MACHINE_H
#define GENERATE_MACHINE_H
#include "model.h"

/* A foot-mounted finned motor, shaft along the frame's z from the drive end at the origin backwards; x is up; feet reach `feet` below. */
void machine_motor(struct item *item, struct frame at, double r, double length, double feet);
/* A yellow guard over a coupling: half round on top, straight sides that reach `down` below the shaft. */
void machine_guard(struct item *item, struct frame at, double r, double length, double down);

#endif
