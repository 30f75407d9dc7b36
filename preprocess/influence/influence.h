/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the influence of sensors on a surface: the weight of each sensor of a group at each vertex while all sensors are
 * good, and the matrix that predicts the value of a lost sensor. INTERPOLATIONS.md explains the methods. Conduction (harmonic,
 * fin): the temperature T of a thin wall obeys -div(k t grad T) + h (T - T_ref) = 0. With u = T - T_ref and the decay length d
 * = sqrt(k t / h) this is -lap u + u / d^2 = 0; harmonic means d = infinity. Each sensor is a disc at the temperature of its
 * reading. Its contact with the points that it covers conducts CONTACT times as well as the surface; two sensors at one
 * position share the contact. The solution minimises E = u' (L + M / d^2) u / 2 + CONTACT / 2 sum_i sum_p s_ip (u_p - v_i)^2.
 * L: stiffness matrix; M: areas of the mesh points; s_ip: share of point p in the disc of sensor i; v_i: reading of sensor i.
 * The solution is linear, u = H v, and the precision matrix P = d^2 E / dv dv is the conductance between the discs. A lost
 * sensor is a disc without flux: (P v)_L = 0 gives its value v_L, and u follows with the same H. */
#ifndef PREPROCESS_INFLUENCE_INFLUENCE_H
#define PREPROCESS_INFLUENCE_INFLUENCE_H
#include "base/log/log.h"
#include "base/workers.h"
#include "preprocess/influence/influence_bend.h"
#include "preprocess/influence/influence_mesh.h"

struct influence {
    size_t count, vertex_count;
    float *shares;     /* H: weight of each sensor at each vertex, stored as [sensor][vertex] */
    double *precision; /* precision matrix P of the sensors, [sensor][sensor] */
    /* by vertex: standard error while all sensors are good (gaussian.h), then by vertex: standard error without any sensor;
     * NULL: not computed. One extra element, 0, allows the file to be padded to 8 bytes */
    float *deviations;
    /* by vertex: largest error of linear interpolation in the adjacent triangles of the asset (influence_bend_measure()); NULL:
     * not requested */
    float *errors;
};

/* Input of influence_conduct() and gaussian_solve(). */
struct influence_task {
    struct log *log;
    struct workers *workers;                /* worker threads; NULL: the calling thread does all work */
    const struct influence_mesh *mesh;      /* the surface and the discs of its sensors */
    const struct influence_anchor *anchors; /* by vertex (vertex_count): its position on the mesh */
    size_t vertex_count;
    /* receives the weights of all sensors at mesh points, to measure the interpolation error inside drawn triangles; NULL: not measured */
    struct influence_bend *bend;
};

/* Computes the influence by conduction. decay_m: decay length; INFINITY for harmonic. Returns false after logging if out of
 * memory. In either case, call influence_finish(). */
bool influence_conduct(struct influence *influence, const struct influence_task *task, double decay_m);
/* Frees the arrays of a computed or zeroed struct influence. */
void influence_finish(struct influence *influence);

#endif
