/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the median time between the usable samples of a series, in bounded memory. Pure. Thread: one. */
#ifndef HISTORY_SPACING_H
#define HISTORY_SPACING_H
#include <stddef.h>

#include "history/point.h"

struct spacing { /* zero-initialise */
    bool has_last, last_usable;
    int64_t last_us;
    int64_t *at; /* every stride-th spacing */
    size_t count, capacity, stride, passed;
    size_t between; /* number of intervals between neighbouring samples, usable or not */
};

/* Adds the next sample in order of time. An interval counts only between two usable samples. */
void spacing_put(struct spacing *spacing, const struct history_point *sample);
/* Returns true if the series has a spacing and at least three samples: two alone do not show how often the series has samples. */
static inline bool spacing_has_rhythm(const struct spacing *spacing)
{
    return spacing->passed > 0 && spacing->between > 1;
}
/* Returns the median spacing in microseconds (of two middle ones the lower); 0 if there is no spacing. Sorts the stored spacings. */
int64_t spacing_median(struct spacing *spacing);
void spacing_finish(struct spacing *spacing);

#endif
