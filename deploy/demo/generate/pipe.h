/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One pipe run: from nozzle to nozzle by corner points, with elbows, insulation, valves and posts. */
#ifndef GENERATE_PIPE_H
#define GENERATE_PIPE_H
#include "equipment.h"

#define PIPE_MAX_POINTS 24

struct pipe {
    struct site *site;
    struct item *item;
    enum material material; /* of bare pipe */
    double r;
    double insulation;      /* thickness, 0: none; clad in aluminium */
    double step_m;          /* longest edge along the pipe; 0.5 unless set */
    struct vec points[PIPE_MAX_POINTS];
    int count;
    struct pipe_gap {       /* in the cladding, around valves */
        struct vec centre;
        double half_m;
    } gaps[4];
    int gap_count;
};

/* Starts at the face of a nozzle with a mating flange, or at a free point. */
struct pipe pipe_from_nozzle(struct site *site, struct item *item, const char *nozzle, double r, enum material material, double insulation);
struct pipe pipe_from_point(struct site *site, struct item *item, struct vec point, double r, enum material material, double insulation);
/* Moves along one axis after the other, in the order of `axes` ("zx": first up or down, then along x), until at `to`. */
void pipe_go(struct pipe *pipe, const char *axes, struct vec to);
/* Goes to a nozzle in that order, ending with a straight piece along the nozzle's axis. */
void pipe_into_nozzle(struct pipe *pipe, const char *axes, const char *nozzle);
/* Things on the last leg, `along` metres after its beginning. */
void pipe_gate_valve(struct pipe *pipe, double along, struct vec wheel);
void pipe_control_valve(struct pipe *pipe, double along, struct vec actuator);
void pipe_post(struct pipe *pipe, double along);
/* Closes the first or the last point with a blind. */
void pipe_blind_first(struct pipe *pipe);
void pipe_blind_last(struct pipe *pipe);
void pipe_end(struct pipe *pipe); /* builds it */

#endif
