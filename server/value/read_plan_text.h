/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a Modbus source will be asked, for people: every request with its addresses on the wire, and what that is for the device. */
#ifndef VALUE_READ_PLAN_TEXT_H
#define VALUE_READ_PLAN_TEXT_H
#include "base/text.h"
#include "plant/plant.h"

/* Of one source; one that is not Modbus gets a line. */
void read_plan_text(struct text *out, const struct plant *plant, int source);

#endif
