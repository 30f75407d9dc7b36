/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The read plan of a Modbus source as readable text: every request with its register addresses, and the load on the device. */
#ifndef VALUE_READ_PLAN_TEXT_H
#define VALUE_READ_PLAN_TEXT_H
#include "base/text/text.h"
#include "plant/plant.h"

/* Appends the read plan of one source. If the source is not Modbus, appends one line that says so. */
void read_plan_text(struct text *out, const struct plant *plant, int source);

#endif
