/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Instants as people write them. Pure, but for local times. */
#ifndef BASE_TIMESTAMP_H
#define BASE_TIMESTAMP_H
#include <stdbool.h>
#include <stdint.h>

/* `2026-11-20T10:00:00.5Z`, the same with an offset (+01:00), seconds since 1970 (1793491200.25), or back from now (-90s, -30m, -8h,
   -7d, now). A date and time without a zone is refused: an hour of every autumn is there twice. */
bool timestamp_parse(const char *text, int64_t now_us, int64_t *t_us);
/* A date and time, with a zone or without: then it is one of the zone of this program (timestamp_use_zone). Where the clocks were put back and
   it was there twice, the earlier one that is later than after_us. False: none, or one that the clocks went past. */
bool timestamp_parse_local(const char *text, int64_t after_us, int64_t *t_us);
void timestamp_use_zone(const char *iana_name); /* of the whole program; only while it has one thread */
#define TIMESTAMP_FORMS "an instant such as 2026-11-20T10:00:00Z (or with an offset, +01:00), seconds since 1970, or -8h"
enum { TIMESTAMP_BYTES = 32 };
void timestamp_print(int64_t t_us, char text[TIMESTAMP_BYTES]); /* 2026-11-20T10:00:00.500Z; microseconds where there are any */

#endif
