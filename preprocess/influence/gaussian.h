/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gaussian process regression on a surface with a Matern kernel of smoothness 1, by finite elements (Lindgren, Rue &
 * Lindstroem, An explicit link between Gaussian fields and Gaussian Markov random fields, 2011; alpha = 2). The precision
 * matrix of the prior is Q = t^2 (k^2 C + G) C^-1 (k^2 C + G). C: diagonal matrix of areas; G: stiffness matrix; t: scale; k =
 * sqrt(8) / range: at a distance of one range the correlation is about 0.14. Each connected body has an independent field and
 * its own unknown mean, which is estimated by generalised least squares. The prior therefore excludes the constant part of the
 * field. t is chosen so that the remainder has the given deviation, as a root mean square over the body's sensors. A reading is
 * the mean over the sensor's disc plus noise. The most probable field is H v for readings v; the rows of H sum to 1 on bodies
 * with a sensor. Let P be the precision matrix of the readings' contrasts. Lost sensors L then get the values that solve (P
 * v)_L = 0. The other sensors predict v_i - (P v)_i / P_ii for sensor i, with standard error 1 / sqrt(P_ii). Losing the sensors
 * L increases the variance by H_L (P_LL)^-1 H_L' (H_L: columns of H for L). */
#ifndef PREPROCESS_INFLUENCE_GAUSSIAN_H
#define PREPROCESS_INFLUENCE_GAUSSIAN_H
#include "preprocess/influence/influence.h"

/* minimum sensor noise as a share of the deviation; with less, two sensors at one position would make the system singular */
#define GAUSSIAN_LEAST_NOISE 0.005
/* number of random samples for estimating the standard deviation; its relative error is at most 1 / sqrt(2 * 256) = 4.4 % */
#define GAUSSIAN_SAMPLES 256

struct gaussian_params {
    /* range: correlation length in metres; noise and deviation (standard deviations) in the unit of the readings */
    double range_m, noise, deviation;
};

/* Computes the weights H, the precision matrix P, and the standard deviation at each vertex, the last from random samples with
 * a fixed seed. Returns false after logging if out of memory or if the system is singular. In either case, call
 * influence_finish(). */
bool gaussian_solve(struct influence *influence, const struct influence_task *task, const struct gaussian_params *params);

#endif
