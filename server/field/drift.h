/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sensors that drift: over a week of hourly means, a reading is what the others say of it (neighbours.h), beside none and with a lag, and
   what the nearest of them read, each times a gain, and a straight line in time. That line is the drift. An hour counts less, the faster
   the plant changes around it: heat is then under way between the places, and no gain says where. Where what is left jumps within hours,
   as it does when a plant is run otherwise from then on, the level may be another one afterwards, twice at most (level shifts found one
   after the other: Chen & Liu, Joint estimation of model parameters and outlier effects in time series, 1993). Each sensor counts less
   what is its own (own[sensor] + common[hour]), so that one that is lost for a day does not move what is said of the others. By weighted
   least squares, whose error is that of dependent residuals (Newey & West 1987), since what a plant does lasts for hours. A sensor that
   drifts pulls at what is said of all the others: the clearest one is found first, and left out before the others are judged. Pure.
   Thread: any. */
#ifndef FIELD_DRIFT_H
#define FIELD_DRIFT_H
#include "field/neighbours.h"

enum { DRIFT_HOURS = 168, DRIFT_HOURS_LEAST = 84 }; /* a week; of fewer nothing is said */
enum { DRIFT_NEAREST = 2 }; /* others that count by themselves, at most */
#define DRIFT_SIGMAS 3.0       /* a drift of so many of its scatter is to be found: */
#define DRIFT_SIGMAS_LEAST 2.5 /* as many count as one, since what is measured errs, */
#define DRIFT_ERRORS 5.0       /* if they are as many of the drift's own standard errors */

enum drift_verdict {
    DRIFT_UNKNOWN, /* too little is recorded, under three sensors, or the plant changed so that a drift could not be told from it */
    DRIFT_NONE,    /* none, and one of DRIFT_SIGMAS would have been seen */
    DRIFT_FOUND,
};

struct drift {
    enum drift_verdict verdict;
    double change;  /* over the week, in the unit; NaN: not known */
    double error;   /* its standard error */
    double scatter; /* sigma: how far readings otherwise are from what follows from the others, noise included */
    int hours;      /* that count */
};

/* One sensor. values, predicted: by hour; NaN: none. nearest: [nearest_count][hours], what as many others read, at most DRIFT_NEAREST.
   noise: by how much a reading errs and is recorded coarsely, above 0. */
void drift_fit(const double *values, const double *predicted, const double *nearest, int nearest_count, int hours, double noise,
               struct drift *out);
/* All sensors that can be asked. values: [hour][sensor]; noise: by sensor; out: by sensor. predicted: [hour][sensor], what is said without
   those that were found, and with what is the sensor's own; may be NULL. Takes (hours * sensors * sensors) steps, and as many again for
   each that is found. */
void drift_find(const struct neighbours *neighbours, const double *values, int hours, const double *noise, struct drift *out,
                double *predicted);

#endif
