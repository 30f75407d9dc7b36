/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Eight numbers at a time, by the compiler's vector extensions: the same bits on every machine. Private to draft*.c and plate*.c. */
#ifndef RENDER_DRAFT_SIMD_H
#define RENDER_DRAFT_SIMD_H
#include <stdint.h>

/* Built for wider registers too; the loader takes what the machine has. Not under sanitizers, whose run time starts after the loader. */
#if defined(__x86_64__) && defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__clang__)
#define DRAFT_KERNEL __attribute__((target_clones("avx2", "default")))
#else
#define DRAFT_KERNEL
#endif
#define DRAFT_INLINE static inline __attribute__((always_inline))

enum { LANES = 8 };
typedef float lanes __attribute__((vector_size(32), aligned(4)));
typedef int32_t lanes_int __attribute__((vector_size(32), aligned(4)));
typedef uint32_t lanes_uint __attribute__((vector_size(32), aligned(4)));
typedef int64_t lanes_pair __attribute__((vector_size(16)));

DRAFT_INLINE lanes lanes_choose(lanes_int mask, lanes a, lanes b)
{
    return (lanes)((mask & (lanes_int)a) | (~mask & (lanes_int)b));
}

DRAFT_INLINE lanes_int lanes_choose_int(lanes_int mask, lanes_int a, lanes_int b)
{
    return (mask & a) | (~mask & b);
}

DRAFT_INLINE lanes lanes_clamp(lanes x, float low, float high)
{
    lanes lows = (lanes){ 0 } + low, highs = (lanes){ 0 } + high;
    x = lanes_choose(x < lows, lows, x);
    return lanes_choose(x > highs, highs, x);
}

DRAFT_INLINE int lanes_any(lanes_int mask)
{
    union {
        lanes_int all;
        lanes_pair halves[2];
    } u = { mask };
    lanes_pair both = u.halves[0] | u.halves[1];
    return (both[0] | both[1]) != 0;
}

/* A bit for each lane, the first one lowest. */
DRAFT_INLINE uint32_t lanes_bits(lanes_int mask)
{
    union {
        lanes_int all;
        lanes_pair halves[2];
    } u = { mask & (lanes_int){ 1, 2, 4, 8, 16, 32, 64, 128 } };
    lanes_pair both = u.halves[0] | u.halves[1];
    uint64_t bits = (uint64_t)(both[0] | both[1]);
    return (uint32_t)(bits | bits >> 32);
}

DRAFT_INLINE lanes_int lanes_whole(lanes x)
{
    return __builtin_convertvector(x, lanes_int);
}

#define LANES_IOTA ((lanes){ 0, 1, 2, 3, 4, 5, 6, 7 })

#endif
