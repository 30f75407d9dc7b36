/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which samples of one tag need keeping: a deadband, then a swinging door, with an override period. Pure; time comes with the samples.
   The promise: at the time of every sample, the line through what was kept is within `2 deadband + deviation` of it; every change
   of quality is kept, and a spike beyond that bound is kept exactly. Source: E. H. Bristol, Swinging door trending, ISA 1990; here the
   line is checked against all the samples it passes, so that the bound is not doubled. */
#ifndef HISTORY_SWINGING_DOOR_H
#define HISTORY_SWINGING_DOOR_H
#include "history/point.h"

struct swinging_door_params {
    double deadband, deviation; /* engineering units, >= 0 */
    int64_t override_us;        /* a point is kept at least this often, while samples come */
    bool step;                  /* values hold until the next: every change beyond the deadband is kept */
};

struct swinging_door { /* zero-initialise */
    bool open, has_skipped, has_held;
    struct history_point anchor;  /* kept last */
    struct history_point held;    /* passed the deadband; kept when the door closes */
    struct history_point skipped; /* the newest, within the deadband of what passed before it */
    double slope_low, slope_high; /* per microsecond: lines from the anchor that pass all samples since */
};

enum { SWINGING_DOOR_MAX_POINTS = 3 };
/* Takes a sample; what must be kept because of it goes to `kept`, oldest first. How many. A sample that is not newer than the last
   (the clock was set back) is kept, and the door begins anew from it. */
int swinging_door_put(struct swinging_door *door, const struct swinging_door_params *params, const struct history_point *sample,
                      struct history_point kept[SWINGING_DOOR_MAX_POINTS]);
/* Keeps the newest sample now, as if the override period were over. */
int swinging_door_end(struct swinging_door *door, const struct swinging_door_params *params,
                      struct history_point kept[SWINGING_DOOR_MAX_POINTS]);
/* The newest sample, where it is not kept yet. It ends the line for whoever reads now, and must outlive a crash. */
bool swinging_door_held(const struct swinging_door *door, struct history_point *out);

#endif
