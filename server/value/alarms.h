/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which alarm of a tag is active. Pure. Thread: any. */
#ifndef VALUE_ALARMS_H
#define VALUE_ALARMS_H
#include "plant/plant.h"
#include "value/snapshot.h"

enum { ALARM_NONE = -1 };
/* An enum limit, the graver of two, or ALARM_NONE: a Good reading at or beyond a limit of its tag. */
int alarm_active(const struct plant_tag *tag, const struct reading *reading);
const char *alarm_name(int alarm); /* "HH"; NULL: none */

#endif
