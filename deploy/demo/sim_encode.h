/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From engineering units to registers: what a device does before a daemon reads it. Shares no code with server/value/decode.c. */
#ifndef DEMO_SIM_ENCODE_H
#define DEMO_SIM_ENCODE_H
#include <stdbool.h>
#include <stdint.h>

#include "plant/plant.h"

/* Registers that the tag takes: 1, 2 or 4; 1 for a coil or a discrete input. */
int sim_encode_width(const struct plant_tag *tag);
/* Puts the value into `words` (0 or 1 for coils and discrete inputs; only its own bit for a bit of a register). What is beyond
   the data type becomes its nearest value. False: the type cannot hold NaN or infinity; words is as it was. */
bool sim_encode(const struct plant_tag *tag, double value, uint16_t *words);

#endif
