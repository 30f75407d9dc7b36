/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses and prints timestamps as people write them. Pure, except for local times. Thread: any, except timestamp_use_zone(). */
#ifndef BASE_TEXT_TIMESTAMP_H
#define BASE_TEXT_TIMESTAMP_H
#include <stdbool.h>
#include <stdint.h>

/* Parses `2026-11-20T10:00:00.5Z`, the same with an offset (+01:00), seconds since 1970 (1793491200.25), or times back from now (-90s,
   -30m, -8h, -7d, now), to microseconds since 1970. Refuses a date and time without a zone, which is ambiguous in autumn. Returns whether
   it is a timestamp. */
bool timestamp_parse(const char *text, int64_t now_us, int64_t *t_us);
/* Parses a date and time with a zone, or without: then in the zone of timestamp_use_zone(). Of a time that the clocks showed twice, takes
   the earlier one that is later than after_us. Returns false if it is no time, or one that the clocks skipped. */
bool timestamp_parse_local(const char *text, int64_t after_us, int64_t *t_us);
void timestamp_use_zone(const char *iana_name); /* sets the zone of the program (TZ); only while it has one thread */
#define TIMESTAMP_FORMS "an instant such as 2026-11-20T10:00:00Z (or with an offset, +01:00), seconds since 1970, or -8h"
enum { TIMESTAMP_BYTES = 32 };
void timestamp_print(int64_t t_us, char text[TIMESTAMP_BYTES]); /* 2026-11-20T10:00:00.500Z; microseconds where there are any */

#endif
