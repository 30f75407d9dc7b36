/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds sensors that drift, from hourly means over a week. A sensor's readings are modelled as the sum of several terms. These
   are a constant; a straight line in time, which is the drift; and, each times a gain, the readings of the nearest sensors and
   the prediction from the other sensors (neighbours.h), now and with a lag. Predictions exclude each sensor's own offset
   (own[sensor] + common[hour]), so that a sensor that is missing for a day does not shift the predictions of others. - Hours in
   which the plant changes fast have less weight: heat then travels between sensors, which no gain can describe. - Where
   residuals jump within hours, as after a change of the plant's operation, the model gets another level, at most twice (level
   shifts found one after the other: Chen & Liu, Joint estimation of model parameters and outlier effects in time series, 1993).
   - Standard errors allow for correlated residuals (Newey & West 1987), because changes of the plant last for hours. - A
   drifting sensor distorts the predictions of all others. Therefore the clearest drift is found first, and its sensor is
   excluded before the others are judged. Pure. Call from any thread. */
#ifndef FIELD_DRIFT_H
#define FIELD_DRIFT_H
#include "field/neighbours.h"

/* DRIFT_HOURS: hours in a week; DRIFT_HOURS_LEAST: a verdict requires at least this many hours in which all sensors have values */
enum { DRIFT_HOURS = 168, DRIFT_HOURS_LEAST = 84 };
enum { DRIFT_NEAREST = 2 }; /* maximum number of nearest sensors whose readings are terms of the model */
/* A drift over the week of this size must be found. In standard deviations (member scatter of struct drift). */
#define DRIFT_SIGMAS 3.0
/* An estimated drift counts as found from this size on, in standard deviations. Smaller than DRIFT_SIGMAS, because the estimate
   of a drift of DRIFT_SIGMAS is sometimes too small. */
#define DRIFT_SIGMAS_LEAST 2.5
#define DRIFT_ERRORS 5.0 /* an estimated drift counts as found only if it is also at least this many times its own standard error */

enum drift_verdict {
    DRIFT_UNKNOWN, /* no verdict: too little data, fewer than three sensors, or changes of the plant that would hide a drift */
    DRIFT_NONE,    /* no drift: a drift of DRIFT_SIGMAS standard deviations would have been found */
    DRIFT_FOUND,
};

struct drift {
    enum drift_verdict verdict;
    double change;  /* drift over the week, in the reading's unit; NaN: unknown */
    double error;   /* standard error of `change` */
    double scatter; /* standard deviation of the differences between readings and model, including noise */
    int hours;      /* number of hours used */
};

/* Returns why there is no verdict (static text without commas); "": there is a verdict. sensors: number of sensors compared. */
const char *drift_unknown_cause(const struct drift *drift, size_t sensors);
/* Decides whether one sensor drifts. values, predicted: [hour]; NaN: no value. nearest: [nearest_count][hours], readings of at
   most DRIFT_NEAREST nearest sensors. noise: error and recording resolution of a reading, greater than 0. */
void drift_fit(const double *values, const double *predicted, const double *nearest, int nearest_count, int hours, double noise,
               struct drift *out);
/* Decides for every sensor of a group that can be predicted whether it drifts. values: [hour][sensor]; noise, out: [sensor].
   predicted: [hour][sensor], output, may be NULL: the value of each sensor predicted from the sensors that do not drift, plus
   the predicted sensor's own offset. Takes (hours * sensors * sensors) steps, and as many again for each drifting sensor. */
void drift_find(const struct neighbours *neighbours, const double *values, int hours, const double *noise, struct drift *out,
                double *predicted);

#endif
