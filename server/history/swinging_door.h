/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Swinging-door filter: decides which samples of a tag are recorded. Combines a deadband, a swinging door, and an override
   period (longest time between two recorded points). No input or output; the samples carry the times. At the time of every
   sample, the line through the recorded points is within `2 deadband + deviation` of the sample. Every change of quality is
   recorded, and a spike beyond that bound is recorded exactly. Source: E. H. Bristol, Swinging door trending, ISA 1990; here
   the line is checked against all samples that it passes, so that the bound is not doubled. */
#ifndef HISTORY_SWINGING_DOOR_H
#define HISTORY_SWINGING_DOOR_H
#include "history/point.h"

struct swinging_door_params {
    /* in the tag's unit, >= 0; deadband: changes below it are ignored; deviation: largest allowed distance of samples from the
       straight line between two recorded points */
    double deadband, deviation;
    int64_t override_us; /* maximum time between two recorded points while samples arrive */
    bool step;           /* true: the tag is a switch: values hold until the next point, and every change beyond the deadband is
                                   recorded */
};

struct swinging_door { /* zero-initialise */
    bool open, has_skipped, has_held;
    struct history_point anchor;  /* point recorded last */
    struct history_point held;    /* newest sample that left the deadband; recorded when a later one does not fit the swinging door */
    struct history_point skipped; /* newest sample, if it stayed within the deadband around the last sample that left it */
    /* slopes, in units per microsecond, of lines from the anchor (point recorded last) that pass all later samples within the
       deviation. slope_low: of the flattest such line; slope_high: of the steepest */
    double slope_low, slope_high;
};

enum { SWINGING_DOOR_MAX_POINTS = 3 };
/* Passes a sample to the filter. Writes the points to be recorded now to `kept`, oldest first, and returns their number. A
   sample that is not newer than the last one (the clock was set back) is recorded, and the filter restarts from it. */
int swinging_door_put(struct swinging_door *door, const struct swinging_door_params *params, const struct history_point *sample,
                      struct history_point kept[SWINGING_DOOR_MAX_POINTS]);
/* Records the newest sample now, as if override_us had passed since the last recorded point. Returns the number of points in `kept`. */
int swinging_door_end(struct swinging_door *door, const struct swinging_door_params *params,
                      struct history_point kept[SWINGING_DOOR_MAX_POINTS]);
/* If the newest sample is not recorded yet, writes it to *out and returns true. The caller stores that sample so that it
   survives a crash, and history queries extend the line up to it. Returns false if the newest sample is recorded. */
bool swinging_door_held(const struct swinging_door *door, struct history_point *out);

#endif
