/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Influence of sensors on a surface: what each of a group's sensors weighs at each vertex while all of them are good, and the matrix from
   which follows what a lost one would say. PLANT.md says what the methods mean.

   Conduction (harmonic, fin): the temperature T of a thin wall obeys -div(k t grad T) + h (T - T_ref) = 0, so with u = T - T_ref
   and the decay length d = sqrt(k t / h): -lap u + u / d^2 = 0; harmonic is d = infinity. Each sensor is a disc that holds its
   reading: tied to the points it covers by a contact that conducts CONTACT times as well as the surface, so that two sensors at one
   place share it. What is minimal is E = u' (L + M / d^2) u / 2 + CONTACT / 2 sum_i sum_p s_ip (u_p - v_i)^2. u = H v, and precision
   P = d^2 E / dv dv is the conductance between the discs. A lost sensor is a disc without flux: (P v)_L = 0 gives its v_L, and u
   follows with the same H. */
#ifndef PREPROCESS_INFLUENCE_INFLUENCE_H
#define PREPROCESS_INFLUENCE_INFLUENCE_H
#include "base/log/log.h"
#include "base/workers.h"
#include "preprocess/influence/influence_bend.h"
#include "preprocess/influence/influence_mesh.h"

struct influence {
    size_t count, vertex_count;
    float *shares;     /* [sensor][vertex]: H */
    double *precision; /* [sensor][sensor] */
    float *deviations; /* by vertex: how far it may err while all sensors are good (gaussian.h), then by vertex what it would be without
                          sensors; NULL: not known. Room for one more, 0 */
    float *errors;     /* by vertex: how far drawn triangles may be off (influence_bend_measure()); NULL: not asked for */
};

/* Computes the influence by conduction; decay_m: INFINITY for harmonic. anchors: of vertex_count vertices on the mesh. bend: takes what all
   sensors come to between the corners of drawn triangles, or NULL. workers may be NULL. Returns false if out of memory, logged. Call
   influence_finish() in both cases. */
bool influence_conduct(struct influence *influence, struct log *log, struct workers *workers, const struct influence_mesh *mesh,
                       double decay_m, const struct influence_anchor *anchors, size_t vertex_count, struct influence_bend *bend);
/* Frees the arrays. A zeroed one is fine. */
void influence_finish(struct influence *influence);

#endif
