/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Flags of the field's value at a vertex: no data, uncertain, no alarm limits. Each flag selects a pattern (hatch, dots, lines) that pixels
   show. Private to soft/. */
#ifndef RENDER_SOFT_FLAGS_H
#define RENDER_SOFT_FLAGS_H
#include "field/scalars.h"

/* Layout of a vertex's flags: bits 0 to 7: scalar.uncertain, bits 8 to 15: scalar.lacking (both 0..255), bit 16: no alarm limits.
   SOFT_UNCERTAIN and SOFT_NO_DATA are the top bits of the two numbers: set if the number is above half. */
enum { SOFT_LACKING = 8, SOFT_NO_DATA = 0x8000, SOFT_UNCERTAIN = 0x80, SOFT_NO_LIMITS = 0x10000 };
enum { SOFT_PATTERNS = SOFT_NO_DATA | SOFT_UNCERTAIN | SOFT_NO_LIMITS };
#define SOFT_NOTHING_KNOWN (255u << SOFT_LACKING)
static inline uint32_t soft_flags(const struct scalar *scalar)
{
    return (uint32_t)scalar->lacking << SOFT_LACKING | scalar->uncertain | (scalar->no_limits ? SOFT_NO_LIMITS : 0);
}
/* soft_lacking(), soft_uncertain() and soft_no_limits() return a flag of a vertex as a number 0..1 that is interpolated over triangles. A
   pixel shows the pattern where that number is above 0.5. */
static inline float soft_lacking(uint32_t flags)
{
    return (float)(flags >> SOFT_LACKING & 0xff) * (1 / 255.0f);
}
static inline float soft_uncertain(uint32_t flags)
{
    return (float)(flags & 0xff) * (1 / 255.0f);
}
static inline float soft_no_limits(uint32_t flags)
{
    return flags & SOFT_NO_LIMITS ? 1 : 0;
}

#endif
