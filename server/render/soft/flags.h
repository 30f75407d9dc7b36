/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a vertex says of its value besides. Private to soft/. */
#ifndef RENDER_SOFT_FLAGS_H
#define RENDER_SOFT_FLAGS_H
#include "field/scalars.h"

/* Two bytes, scalar.uncertain and from bit SOFT_LACKING on scalar.lacking; and a bit. */
enum { SOFT_LACKING = 8, SOFT_NO_DATA = 0x8000, SOFT_UNCERTAIN = 0x80, SOFT_NO_LIMITS = 0x10000 };
enum { SOFT_PATTERNS = SOFT_NO_DATA | SOFT_UNCERTAIN | SOFT_NO_LIMITS };
#define SOFT_NOTHING_KNOWN (255u << SOFT_LACKING)
static inline uint32_t soft_flags(const struct scalar *scalar)
{
    return (uint32_t)scalar->lacking << SOFT_LACKING | scalar->uncertain | (scalar->no_limits ? SOFT_NO_LIMITS : 0);
}
/* 0..1; above 0.5 there is no data, or it is uncertain. */
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
