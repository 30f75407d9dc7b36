/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rate limit for log lines about one repeating state. The first line is due immediately, later ones after pauses that double
   from `first_ns` to `longest_ns`; each states how many occurrences were suppressed. Pure; the caller passes now_ns. Call from
   one thread only. */
#ifndef BASE_LOG_LOG_PACE_H
#define BASE_LOG_LOG_PACE_H
#include <stdbool.h>
#include <stdint.h>

enum { LOG_PACE_BYTES = 64 };

struct log_pace { /* rate limit of one kind of log line. Set first_ns and longest_ns, and all other members to zero */
    int64_t first_ns, longest_ns;
    /* pause_ns: length of the current pause; next_ns: monotonic time when it ends; 0: no line has been written yet */
    int64_t pause_ns, next_ns;
    long unsaid;
};

/* Counts one occurrence of the state. Returns true if a log line is due now; `more` then receives the text to append: "" or " (and 5
   more in the last 60 s)". */
bool log_pace_take(struct log_pace *pace, int64_t now_ns, char more[LOG_PACE_BYTES]);
/* Returns true if a pause has ended in which occurrences were suppressed, and starts the next pause. `more` then receives a
   text with their number. */
bool log_pace_flush(struct log_pace *pace, int64_t now_ns, char more[LOG_PACE_BYTES]);

#endif
