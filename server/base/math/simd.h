/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loops that are built more than once, for processors with wider registers; all builds give the same bits, since none multiplies and adds
   at once. Two ways: SIMD_CLONES lets the compiler and the loader do it, for loops that the compiler vectorizes by itself; where code is
   written for a set of instructions, or whole files are built again, simd_level() chooses. */
#ifndef BASE_MATH_SIMD_H
#define BASE_MATH_SIMD_H
#include <stdbool.h>

enum simd_level { SIMD_PLAIN, SIMD_HAS_AVX2, SIMD_HAS_AVX512 }; /* AVX-512: F, VL, BW and DQ */

/* Write the loop as a SIMD_BODY function, and call it from a plain function and from one marked SIMD_AVX2. */
#define SIMD_BODY static inline __attribute__((always_inline))
#if defined(__x86_64__)
#define SIMD_AVX2 __attribute__((target("avx2")))
/* Returns the widest set that this machine has. */
static inline enum simd_level simd_level(void)
{
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512dq"))
        return SIMD_HAS_AVX512;
    return __builtin_cpu_supports("avx2") ? SIMD_HAS_AVX2 : SIMD_PLAIN;
}
static inline bool simd_has_avx2(void)
{
    return __builtin_cpu_supports("avx2");
}
#else
#define SIMD_AVX2
static inline enum simd_level simd_level(void)
{
    return SIMD_PLAIN;
}
static inline bool simd_has_avx2(void)
{
    return false;
}
#endif

/* SIMD_CLONES("avx2") before a function: built for each of these sets and for none; the loader takes what the machine has. Not under
   sanitizers, whose run time starts after the loader. */
#if defined(__x86_64__) && defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__clang__)
#define SIMD_CLONES(...) __attribute__((target_clones(__VA_ARGS__, "default")))
#else
#define SIMD_CLONES(...)
#endif

#endif
