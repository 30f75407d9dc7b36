/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Selects the rules of `notify` that apply to an alarm. Pure except for the local time of the process's zone, which is the plant's.
   Thread: any. */
#ifndef NOTIFY_SHIFT_H
#define NOTIFY_SHIFT_H
#include <stdbool.h>
#include <stdint.h>

#include "plant/plant.h"
#include "plant/sections/notification.h"

/* Returns whether the shift is active at that time, by the local wall clock: on nights when the clocks change, a shift is longer or
   shorter by an hour. */
bool shift_is_on(const struct notify_shift *shift, int64_t utc_us);
/* Returns a bit mask of the rules for an alarm of that name and priority. tag: index, or -1 for a device's alarm. */
uint32_t rules_for(const struct plant *plant, const char *name, int tag, int priority, int64_t utc_us);

#endif
