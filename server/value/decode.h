/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From the registers or the bit of a tag to its reading, in the unit of the tag. No I/O, no clock. */
#ifndef VALUE_DECODE_H
#define VALUE_DECODE_H
#include <stdint.h>

#include "plant/plant.h"
#include "value/store.h"

/* What the tag takes on the wire: 16-bit registers (1, 2 or 4), or 1 for a coil or a discrete input. */
int decode_width(const struct plant_tag *tag);
/* words: decode_width() of them, as received (each already in the machine's order); for coils and discrete inputs 0 or 1.
   Fills value and quality: Good, Uncertain_EngineeringUnitsExceeded beyond the instrument's range (the value goes on beyond it),
   Bad_SensorFailure for NaN, infinity, what is no BCD number, an open circuit's value and a current that NE 43 calls a failure.
   negate turns a bit over and a number's sign. */
void decode_sample(const struct plant_tag *tag, const uint16_t *words, struct sample *out);

#endif
