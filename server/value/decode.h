/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts a tag's Modbus registers, its Modbus bit, or a published number to a value in engineering units, with a quality. No side
   effects, no clock. */
#ifndef VALUE_DECODE_H
#define VALUE_DECODE_H
#include <stdint.h>

#include "plant/plant.h"
#include "value/store.h"

/* Returns how many 16-bit registers the tag occupies (1, 2 or 4); 1 for a coil or a discrete input. */
int decode_width(const struct plant_tag *tag);
/* Decodes a tag's registers into out->value and out->quality. words: decode_width() registers, each in the host's byte order; for coils
   and discrete inputs 0 or 1. The quality is Good, or Uncertain_EngineeringUnitsExceeded beyond the instrument's range (the value is
   extrapolated). It is Bad_SensorFailure for NaN, infinity, invalid BCD, a special value that means a failure, and a current that NE 43
   defines as a failure. The tag's option `negate` inverts a bit and changes the sign of a number. */
void decode_sample(const struct plant_tag *tag, const uint16_t *words, struct sample *out);

/* Decodes a value that a source received as a number rather than as registers, by the same rules as decode_sample(). For a tag
 * of type bool, the number becomes 0 or 1. */
void decode_number(const struct plant_tag *tag, double raw, struct sample *out);

/* Returns the quality of a value that is already in the tag list's unit: Good, Uncertain_EngineeringUnitsExceeded beyond the
   instrument's range, or Bad_SensorFailure if not finite. */
uint32_t decode_quality(const struct plant_tag *tag, double value);

#endif
