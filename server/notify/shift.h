/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Selects the rules of `notify` that apply to an alarm, by shift, area and priority. Depends only on the arguments and the
   local time zone, which is the plant's. Call from any thread. */
#ifndef NOTIFY_SHIFT_H
#define NOTIFY_SHIFT_H
#include <stdbool.h>
#include <stdint.h>

#include "plant/plant.h"
#include "plant/sections/notification.h"

/* Returns true if the shift is on duty at that time, by the local wall clock. On nights when the clocks change, a shift is an
   hour longer or shorter. */
bool shift_is_on(const struct notify_shift *shift, int64_t utc_us);
/* Returns a bit mask of the plant's notification rules that apply to an alarm of that tag or device and that priority. tag:
   index of the tag; -1: the alarm is a device's. */
uint32_t rules_for(const struct plant *plant, const char *name, int tag, int priority, int64_t utc_us);

#endif
