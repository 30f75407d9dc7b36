/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Paces log lines about one state that repeats: one line at once, later ones after pauses that double from `first_ns` to `longest_ns`,
   each with the number of times left out. Pure; now_ns is handed in. Thread: one. */
#ifndef BASE_LOG_LOG_PACE_H
#define BASE_LOG_LOG_PACE_H
#include <stdbool.h>
#include <stdint.h>

enum { LOG_PACE_BYTES = 64 };

struct log_pace { /* zero-initialise apart from the pauses */
    int64_t first_ns, longest_ns;
    int64_t pause_ns, next_ns; /* next_ns 0: no line was written yet */
    long unsaid;
};

/* Counts one occurrence. Returns whether a line is due now; then `more` is what to append: "" or " (and 5 more in the last 60 s)". */
bool log_pace_take(struct log_pace *pace, int64_t now_ns, char more[LOG_PACE_BYTES]);
/* Returns whether a pause has ended with occurrences left out, and starts the next pause; then `more` is how many. */
bool log_pace_flush(struct log_pace *pace, int64_t now_ns, char more[LOG_PACE_BYTES]);

#endif
