/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The saddles of horizontal vessels. */
#ifndef GENERATE_SADDLE_H
#define GENERATE_SADDLE_H
#include "mesh.h"

/* Under a shell of radius r whose axis runs along x at axis_z; the base plate stands on base_z. at.x: station along the axis. */
void saddle_build(struct mesh *mesh, double x, double axis_z, double base_z, double r);

#endif
