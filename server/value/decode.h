/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes the Modbus registers or the bit of a tag, or a number that was published, into a reading in engineering units.
   Pure: no I/O, no clock. */
#ifndef VALUE_DECODE_H
#define VALUE_DECODE_H
#include <stdint.h>

#include "plant/plant.h"
#include "value/store.h"

/* Returns how many 16-bit registers the tag occupies (1, 2 or 4); 1 for a coil or a discrete input. */
int decode_width(const struct plant_tag *tag);
/* Decodes what was received for a tag into out->value and out->quality. words: decode_width() registers, each in the machine's byte order;
   for coils and discrete inputs 0 or 1. Quality is Good; Uncertain_EngineeringUnitsExceeded beyond the instrument's range (the value is
   extrapolated); or Bad_SensorFailure for NaN, infinity, invalid BCD, the open-circuit value, and a current that NE 43 defines as a
   failure. The tag's negate inverts a bit, or the sign of a number. */
void decode_sample(const struct plant_tag *tag, const uint16_t *words, struct sample *out);

/* Decodes a number that came as such, not as registers, in the same way; bits are what has the type bool. */
void decode_number(const struct plant_tag *tag, double raw, struct sample *out);

#endif
