/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A Gaussian process on a surface with a Matern kernel of smoothness 1, by finite elements (Lindgren, Rue & Lindstroem, An explicit link
   between Gaussian fields and Gaussian Markov random fields, 2011; alpha = 2).

   Its precision is Q = t^2 (k^2 C + G) C^-1 (k^2 C + G), with lumped areas C, stiffness G and k = sqrt(8) / range: at the range, places
   correlate by about 0.14. Each connected body has a field of its own about a mean of its own, which is not known but estimated by
   generalised least squares. So a field that is the same everywhere on a body has no part in the prior, and t is chosen so that what
   is left has the stated deviation at the body's sensors, in the mean of squares.

   A reading is the mean over the sensor's disc plus noise. What is most probable is H v, whose rows add up to 1 on bodies with a sensor;
   precision P of the readings' contrasts gives what lost sensors would say (P v)_L = 0, what the others say of sensor i,
   v_i - (P v)_i / P_ii, and by how much that errs, 1 / sqrt(P_ii). With sensors L lost the variance grows by H_L (P_LL)^-1 H_L'. */
#ifndef PREPROCESS_INFLUENCE_GAUSSIAN_H
#define PREPROCESS_INFLUENCE_GAUSSIAN_H
#include "preprocess/influence/influence.h"

#define GAUSSIAN_LEAST_NOISE 0.005 /* of the deviation: less would make sensors at one place a riddle without a solution */
#define GAUSSIAN_SAMPLES 256       /* of which the deviation is measured: it errs by at most 1 / sqrt(2 * 256) = 4.4 % */

struct gaussian_params {
    double range_m, noise, deviation; /* noise and deviation in the unit of the readings */
};

/* Computes H, P and, by random samples that are always the same, the standard deviation at each vertex. anchors: of vertex_count vertices
   on the mesh. bend: takes what all sensors come to between the corners of drawn triangles, or NULL. workers may be NULL. Returns false if
   out of memory or if the system has no solution, logged. Call influence_finish() in both cases. */
bool gaussian_solve(struct influence *influence, struct log *log, struct workers *workers, const struct influence_mesh *mesh,
                    const struct gaussian_params *params, const struct influence_anchor *anchors, size_t vertex_count,
                    struct influence_bend *bend);

#endif
