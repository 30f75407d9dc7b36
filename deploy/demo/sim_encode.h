/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Encodes values in engineering units as registers, as a device does. Shares no code with server/value/decode.c, which it
   tests. Call from any thread. */
#ifndef DEMO_SIM_ENCODE_H
#define DEMO_SIM_ENCODE_H
#include <stdbool.h>
#include <stdint.h>

#include "plant/plant.h"

/* Returns the number of registers of a tag: 1, 2 or 4; 1 for a coil or a discrete input. */
int sim_encode_width(const struct plant_tag *tag);
/* Returns the raw number, before scaling, of a value in engineering units; for a bit 0 or 1. */
double sim_encode_raw(const struct plant_tag *tag, double value);
/* Writes the value to `words` (0 or 1 for coils and discrete inputs; for a bit of a register, only that bit). Clamps it to the data
   type. Returns false, with `words` unchanged, if the type cannot hold NaN or infinity. */
bool sim_encode(const struct plant_tag *tag, double value, uint16_t *words);

#endif
