/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loops over many floats, twice as wide where the processor can. */
#ifndef BASE_WIDE_H
#define BASE_WIDE_H
#include <stdbool.h>

/* Write the loop as a WIDE_BODY function, call it from a plain function and from one marked WIDE_TARGET, and choose by wide_is_there().
   The numbers are the same: the wider set has no instruction that multiplies and adds at once. */
#define WIDE_BODY static inline __attribute__((always_inline))
#if defined(__x86_64__)
#define WIDE_TARGET __attribute__((target("avx2")))
static inline bool wide_is_there(void)
{
    return __builtin_cpu_supports("avx2");
}
#else
#define WIDE_TARGET
static inline bool wide_is_there(void)
{
    return false;
}
#endif

#endif
