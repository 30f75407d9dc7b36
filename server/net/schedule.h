/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whose picture is drawn next. Each wish is due a while after it was made, by its urgency; the earliest due goes first. So moving
   sessions go before refinements, and yet nobody waits for ever. Pure. */
#ifndef NET_SCHEDULE_H
#define NET_SCHEDULE_H
#include <stdint.h>

enum urgency { URGENCY_INPUT, URGENCY_DATA, URGENCY_REFINE, URGENCY_SNAPSHOT };

int64_t schedule_due_ns(enum urgency urgency, int64_t asked_ns);

#endif
