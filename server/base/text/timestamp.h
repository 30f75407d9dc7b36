/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses and prints human-readable timestamps. Pure, except for local times. Call from any thread, except timestamp_use_zone(). */
#ifndef BASE_TEXT_TIMESTAMP_H
#define BASE_TEXT_TIMESTAMP_H
#include <stdbool.h>
#include <stdint.h>

/* Parses a timestamp to microseconds since 1970: `2026-11-20T10:00:00.5Z`, the same with an offset (+01:00), seconds since 1970
   (1793491200.25), or a time relative to now (-90s, -30m, -8h, -7d, now). Refuses a date and time without a zone, which is
   ambiguous in autumn. Returns true if the text is a timestamp. */
bool timestamp_parse(const char *text, int64_t now_us, int64_t *t_us);
/* Parses a date and time; if it has no zone, in the zone set by timestamp_use_zone(). If the local time occurs twice, *t_us
   receives the earlier of the instants that are later than after_us. Returns false if the text is not a time, or a local time
   that the clocks skip. */
bool timestamp_parse_local(const char *text, int64_t after_us, int64_t *t_us);
void timestamp_use_zone(const char *iana_name); /* Sets the process's time zone (TZ); call it only while the process has one thread. */
#define TIMESTAMP_FORMS                                                                                                                    \
    "a time such as 2026-11-20T10:00:00Z (or with an offset such as +01:00), seconds since 1970, or a time before now such as -8h"
enum { TIMESTAMP_BYTES = 32 };
/* Prints a time as 2026-11-20T10:00:00.500Z, or with six decimals if it is not a whole number of milliseconds. */
void timestamp_print(int64_t t_us, char text[TIMESTAMP_BYTES]);

#endif
