/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds loops several times for processors with wider registers. All builds give identical bits, since none uses fused multiply-add.
   Two ways: SIMD_CLONES leaves the choice to compiler and loader, for loops that the compiler vectorises by itself; simd_level() is for
   code written for one instruction set, and for whole files compiled several times. */
#ifndef BASE_MATH_SIMD_H
#define BASE_MATH_SIMD_H
#include <stdbool.h>

enum simd_level { SIMD_PLAIN, SIMD_HAS_AVX2, SIMD_HAS_AVX512 }; /* SIMD_HAS_AVX512: the processor has AVX-512 F, VL, BW and DQ */

/* To build a loop for AVX2 as well, write it as a SIMD_BODY function, and call that from a plain function and from a function marked
   SIMD_AVX2. */
#define SIMD_BODY static inline __attribute__((always_inline))
#if defined(__x86_64__)
#define SIMD_AVX2 __attribute__((target("avx2")))
/* Returns the widest instruction set of this machine. */
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

/* SIMD_CLONES("avx2") before a function builds it for plain processors and for AVX2; the loader selects the build that fits the machine.
   Disabled under sanitizers, whose run time starts after the loader. */
#if defined(__x86_64__) && defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__clang__)
#define SIMD_CLONES(...) __attribute__((target_clones(__VA_ARGS__, "default")))
#else
#define SIMD_CLONES(...)
#endif

#endif
