/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Comparison of numbers for qsort(), and a binary search with an arbitrary condition, where bsearch() does not fit. */
#ifndef BASE_SEARCH_H
#define BASE_SEARCH_H
#include <stddef.h>
#include <stdint.h>

/* Compares doubles, for qsort(). */
static inline int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Compares int64_t, for qsort(). */
static inline int compare_int64(const void *a, const void *b)
{
    int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

/* Sets `at` to the first index for which `precedes`, an expression in `at`, is false; to `count` if there is none. `precedes`
   must be true for all indices below some bound and false from there on. */
#define search_sorted(at, count, precedes)                                                                                                 \
    do {                                                                                                                                   \
        size_t low_ = 0, high_ = (size_t)(count);                                                                                          \
        while (low_ < high_) {                                                                                                             \
            (at) = low_ + (high_ - low_) / 2;                                                                                              \
            if (precedes)                                                                                                                  \
                low_ = (at) + 1;                                                                                                           \
            else                                                                                                                           \
                high_ = (at);                                                                                                              \
        }                                                                                                                                  \
        (at) = low_;                                                                                                                       \
    } while (0)

#endif
