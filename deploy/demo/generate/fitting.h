/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What sits on pipes and vessels: flanges with bolts, nozzles, valves, supports. r is always the pipe's outside radius. */
#ifndef GENERATE_FITTING_H
#define GENERATE_FITTING_H
#include "model.h"

double fitting_flange_radius(double r);
double fitting_flange_thickness(double r);
/* One weld-neck flange: face at the frame's origin looking along z, hub behind it. */
void fitting_flange(struct mesh *mesh, struct frame at, double r);
/* Studs through a pair of flanges whose gasket is at the origin. */
void fitting_studs(struct mesh *mesh, struct frame at, double r);

/* A neck from inside the shell (the neck just ends there) to a flange `length` above `surface`; uses item->necks and ->flanges. */
struct frame item_nozzle(struct item *item, const char *name, struct vec surface, struct vec dir, double r, double length);
void item_manway(struct item *item, struct vec surface, struct vec dir, double r, double length);

/* Valves: z along the pipe, x towards the handwheel or actuator; flanged both sides. The length between gaskets comes back. */
double fitting_valve_length(double r);
void fitting_gate_valve(struct item *item, struct frame at, double r);
void fitting_control_valve(struct item *item, struct frame at, double r);

/* A steel post that holds a pipe whose underside is at `under`; access, civil: where steel and plinth go. All in the plant frame. */
void fitting_post(struct item *access, struct item *civil, struct vec under, double r);
void fitting_pipe_shoe(struct item *access, struct vec under, struct vec along, double height);

#endif
