/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vectors of eight numbers (lanes). They use the compiler's vector extensions, and intrinsics where the compiler would not choose the right
   instruction. Results are bit-identical on every machine. Private to soft/. */
#ifndef RENDER_SOFT_LANES_H
#define RENDER_SOFT_LANES_H
#include <stdint.h>
#ifdef __AVX2__
#include <immintrin.h>
#endif

#include "base/math/simd.h"

#define SOFT_KERNEL SIMD_CLONES("avx2")
#define SOFT_INLINE SIMD_BODY
#ifndef SOFT_SET /* suffix in the names of functions whose files are compiled once for each instruction set (kernels.h) */
#define SOFT_SET _plain
#endif
#define SOFT_JOIN(name, set) name##set
#define SOFT_IN_SET(name, set) SOFT_JOIN(name, set)

/* number of elements per vector: eight pixels are processed at once. At most SOFT_STRETCH_LEAST, so that the sky's elevation is linear over
   eight pixels (soft_impl.h) */
enum { LANES = 8 };
typedef float lanes __attribute__((vector_size(32), aligned(4)));
typedef int32_t lanes_int __attribute__((vector_size(32), aligned(4)));
typedef uint32_t lanes_uint __attribute__((vector_size(32), aligned(4)));
typedef float quad __attribute__((vector_size(16), aligned(4)));
typedef int32_t quad_int __attribute__((vector_size(16), aligned(4)));
typedef uint8_t lanes_bytes __attribute__((vector_size(8)));
typedef int64_t lanes_pair __attribute__((vector_size(16)));

#ifdef __AVX512VL__
/* 1: lanes_choose() compiles to a single instruction, so computing both results and choosing is cheaper than branching */
#define LANES_CHOOSE_AT_ONCE 1
#else
#define LANES_CHOOSE_AT_ONCE 0
#endif

SOFT_INLINE lanes_int lanes_choose_int(lanes_int mask, lanes_int a, lanes_int b)
{
#if LANES_CHOOSE_AT_ONCE
    return (lanes_int)_mm256_ternarylogic_epi32((__m256i)mask, (__m256i)a, (__m256i)b, 0xca);
#else
    return (mask & a) | (~mask & b);
#endif
}

SOFT_INLINE lanes lanes_choose(lanes_int mask, lanes a, lanes b)
{
    return (lanes)lanes_choose_int(mask, (lanes_int)a, (lanes_int)b);
}

/* Returns the smaller of a and b in each lane: a < b ? a : b. */
SOFT_INLINE lanes lanes_least(lanes a, lanes b)
{
#ifdef __AVX2__
    return (lanes)_mm256_min_ps((__m256)a, (__m256)b);
#else
    return lanes_choose(a < b, a, b);
#endif
}

/* Returns the larger of a and b in each lane: a > b ? a : b. */
SOFT_INLINE lanes lanes_most(lanes a, lanes b)
{
#ifdef __AVX2__
    return (lanes)_mm256_max_ps((__m256)a, (__m256)b);
#else
    return lanes_choose(a > b, a, b);
#endif
}

SOFT_INLINE lanes lanes_clamp(lanes x, float low, float high)
{
    return lanes_least((lanes){ 0 } + high, lanes_most((lanes){ 0 } + low, x));
}

SOFT_INLINE int lanes_any(lanes_int mask)
{
#ifdef __AVX2__
    return !_mm256_testz_si256((__m256i)mask, (__m256i)mask);
#else
    union {
        lanes_int all;
        lanes_pair halves[2];
    } u = { mask };
    lanes_pair both = u.halves[0] | u.halves[1];
    return (both[0] | both[1]) != 0;
#endif
}

/* Returns the eight elements of a mask as bits; element 0 is the lowest bit. */
SOFT_INLINE uint32_t lanes_bits(lanes_int mask)
{
#ifdef __AVX2__
    return (uint32_t)_mm256_movemask_ps((__m256)mask);
#else
    union {
        lanes_int all;
        lanes_pair halves[2];
    } u = { mask & (lanes_int){ 1, 2, 4, 8, 16, 32, 64, 128 } };
    lanes_pair both = u.halves[0] | u.halves[1];
    uint64_t bits = (uint64_t)(both[0] | both[1]);
    return (uint32_t)(bits | bits >> 32);
#endif
}

SOFT_INLINE lanes_int lanes_whole(lanes x)
{
    return __builtin_convertvector(x, lanes_int);
}

/* Returns log2(x) with an error of at most 1e-7; x below 1e-30 counts as 1e-30. */
SOFT_INLINE lanes lanes_log2(lanes x)
{
    lanes tiny = (lanes){ 0 } + 1e-30f;
    lanes_int bits = (lanes_int)lanes_choose(x > tiny, x, tiny), exponent = (bits - LOG2_SPLIT_BITS) >> 23;
    lanes r = (lanes)(bits - exponent * (1 << 23)) - 1.0f, p;
    LOG2_POLYNOMIAL(p, r);
    return __builtin_convertvector(exponent, lanes) + r * p;
}

/* Returns 2^x for x <= 0; below -126 the result is 0. */
SOFT_INLINE lanes lanes_exp2_down(lanes x)
{
    x = lanes_most(x, (lanes){ 0 } - 127.0f);
    lanes_int whole = lanes_whole(x - 0.5f);
    lanes f = x - __builtin_convertvector(whole, lanes), p;
    EXP2_POLYNOMIAL(p, f);
    return p * (lanes)((whole + 127) * (1 << 23));
}

/* 2^x, from 2^-126 to 2^126. */
SOFT_INLINE lanes lanes_exp2(lanes x)
{
    lanes one = (lanes){ 0 } + 1.0f, down = lanes_exp2_down(lanes_most(lanes_least(x, -x), (lanes){ 0 } - 126.0f));
    return lanes_choose(x > 0.0f, one / down, down);
}

SOFT_INLINE lanes lanes_root(lanes x)
{
#ifdef __AVX2__
    return (lanes)_mm256_sqrt_ps((__m256)x);
#else
    for (int i = 0; i < LANES; i++)
        x[i] = __builtin_sqrtf(x[i]);
    return x;
#endif
}

SOFT_INLINE lanes_int lanes_from_bytes(const uint8_t *at)
{
    lanes_bytes eight;
    __builtin_memcpy(&eight, at, sizeof(eight));
    return __builtin_convertvector(eight, lanes_int);
}

/* Looks up table[i] for the index i in each lane of `at`. */
SOFT_INLINE lanes lanes_look_up(const float *table, lanes_int at)
{
#ifdef __AVX2__
    return (lanes)_mm256_i32gather_ps(table, (__m256i)at, sizeof(float));
#else
    lanes out;
    for (int l = 0; l < LANES; l++)
        out[l] = table[at[l]];
    return out;
#endif
}

#define LANES_IOTA_INT ((lanes_int){ 0, 1, 2, 3, 4, 5, 6, 7 })
#define LANES_IOTA ((lanes){ 0, 1, 2, 3, 4, 5, 6, 7 })

#endif
