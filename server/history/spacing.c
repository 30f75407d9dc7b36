/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the median time between samples. Stores at most MAX_SPACINGS times: of a longer series only every second one, then
   every fourth, and so on. */
#include "history/spacing.h"

#include <stdlib.h>

#include "base/math/search.h"
#include "base/mem.h"

enum { MAX_SPACINGS = 4096 };

static void halve(struct spacing *spacing)
{
    for (size_t i = 0; 2 * i < spacing->count; i++)
        spacing->at[i] = spacing->at[2 * i];
    spacing->count = (spacing->count + 1) / 2;
    spacing->stride *= 2;
}

void spacing_put(struct spacing *spacing, const struct history_point *sample)
{
    bool usable = history_point_usable(sample), counts = spacing->has_last && spacing->last_usable && usable;
    int64_t spacing_us = sample->t_us - spacing->last_us;
    spacing->between += spacing->has_last && spacing_us > 0;
    spacing->has_last = true;
    spacing->last_usable = usable;
    spacing->last_us = sample->t_us;
    if (!counts || spacing_us <= 0)
        return;
    spacing->stride = spacing->stride ? spacing->stride : 1;
    if (spacing->passed++ % spacing->stride)
        return;
    if (spacing->count == MAX_SPACINGS)
        halve(spacing);
    mem_grow(&spacing->at, &spacing->capacity, spacing->count + 1, sizeof(*spacing->at));
    spacing->at[spacing->count++] = spacing_us;
}

int64_t spacing_median(struct spacing *spacing)
{
    if (!spacing->count)
        return 0;
    qsort(spacing->at, spacing->count, sizeof(*spacing->at), compare_int64);
    return spacing->at[(spacing->count - 1) / 2];
}

void spacing_finish(struct spacing *spacing)
{
    mem_free(spacing->at);
    *spacing = (struct spacing){ 0 };
}
