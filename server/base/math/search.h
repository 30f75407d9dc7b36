/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Binary search in sorted elements that bsearch() does not suit: elements found by position, or reached through an index. */
#ifndef BASE_SEARCH_H
#define BASE_SEARCH_H
#include <stddef.h>

/* Sets `at` to the first index for which `precedes`, an expression in `at`, is false; to `count` if there is none. `precedes` must not
   become true again once it was false. */
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
