/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the median time between the usable samples of a series in bounded memory. No input or output. Call from one thread only. */
#ifndef HISTORY_SPACING_H
#define HISTORY_SPACING_H
#include <stddef.h>

#include "history/point.h"

struct spacing { /* zero-initialise */
    bool has_last, last_usable;
    int64_t last_us;
    int64_t *at; /* times between consecutive usable samples, in microseconds; of a long series only every stride-th time is stored */
    size_t count, capacity, stride, passed;
    size_t between; /* number of times between adjacent samples, usable or not */
};

/* Adds the next sample in order of time. The time since the previous sample counts only if both are usable. */
void spacing_put(struct spacing *spacing, const struct history_point *sample);
/* Returns true if a typical time between samples can be computed. That takes at least three samples, because two do not show
   how often the series has samples. */
static inline bool spacing_has_rhythm(const struct spacing *spacing)
{
    return spacing->passed > 0 && spacing->between > 1;
}
/* Returns the median time between samples in microseconds (the lower of the two middle ones); 0 if there is none. Sorts the
   stored times. */
int64_t spacing_median(struct spacing *spacing);
void spacing_finish(struct spacing *spacing);

#endif
