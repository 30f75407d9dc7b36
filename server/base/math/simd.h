/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds loops several times, for processors with wider registers. All builds give identical bits, because none uses fused
   multiply-add. Two ways: SIMD_CLONES leaves the choice to compiler and loader, for loops that the compiler vectorises by
   itself; simd_level() is for code written for one instruction set, and for whole files compiled several times. */
#ifndef BASE_MATH_SIMD_H
#define BASE_MATH_SIMD_H
#include <stdbool.h>

enum simd_level { SIMD_PLAIN, SIMD_HAS_AVX2, SIMD_HAS_AVX512 }; /* SIMD_HAS_AVX512: the processor has AVX-512 F, VL, BW and DQ */

/* To build a loop for AVX2 as well, write it as a SIMD_BODY function, and call it from a plain function and from a function
   marked SIMD_AVX2. */
#define SIMD_BODY static inline __attribute__((always_inline))
#if defined(__x86_64__)
#define SIMD_AVX2 __attribute__((target("avx2")))
/* Returns the widest instruction set that this machine supports. */
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

/* SIMD_CLONES("avx2") before a function builds it for plain processors and for AVX2; the loader selects the build that fits the
   machine. Disabled under sanitizers, whose runtime starts only after the loader. */
#if defined(__x86_64__) && defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__clang__)
#define SIMD_CLONES(...) __attribute__((target_clones(__VA_ARGS__, "default")))
#else
#define SIMD_CLONES(...)
#endif

/* Polynomials for 2^x and log2(x), for floats and for vectors of floats. Each macro assigns the polynomial's value at x to p. */
#define LOG2_SPLIT_BITS 0x3f3504f3 /* bit pattern of the float sqrt(1/2): LOG2_POLYNOMIAL is valid for mantissas from there to sqrt(2) */

/* Minimax polynomial of log2(1 + x)/x over [sqrt(1/2) - 1, sqrt(2) - 1]. */
#define LOG2_POLYNOMIAL(p, x) \
    do { \
        (p) = (x) * -0.1457575112581253f; \
        (p) += 0.23688247799873352f; \
        (p) = (p) * (x) - 0.25006118416786194f; \
        (p) = (p) * (x) + 0.2867085337638855f; \
        (p) = (p) * (x) - 0.3600881099700928f; \
        (p) = (p) * (x) + 0.4809393882751465f; \
        (p) = (p) * (x) - 0.7213571071624756f; \
        (p) = (p) * (x) + 1.4426947832107544f; \
    } while (0)

/* Minimax polynomial of 2^x over [-1/2, 1/2]. */
#define EXP2_POLYNOMIAL(p, x) \
    do { \
        (p) = (x) * 0.0013407237129285932f; \
        (p) += 0.009671861305832863f; \
        (p) = (p) * (x) + 0.055503085255622864f; \
        (p) = (p) * (x) + 0.24022234976291656f; \
        (p) = (p) * (x) + 0.6931472420692444f; \
        (p) = (p) * (x) + 1.0f; \
    } while (0)

#endif
