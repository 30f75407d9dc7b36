/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which rules of `notify` an alarm falls under. Pure but for the local time of the program's zone, which is the plant's. Thread: any. */
#ifndef NOTIFY_SHIFT_H
#define NOTIFY_SHIFT_H
#include <stdbool.h>
#include <stdint.h>

#include "plant/plant.h"
#include "plant/sections/notification.h"

/* Returns whether the shift is on at that time. On the nights when clocks change, a shift is as long as its hours on the wall. */
bool shift_is_on(const struct notify_shift *shift, int64_t utc_us);
/* Returns the rules (bits) for an alarm of that name and priority. tag: -1 for a device's. */
uint32_t rules_for(const struct plant *plant, const char *name, int tag, int priority, int64_t utc_us);

#endif
