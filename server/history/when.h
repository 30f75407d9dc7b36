/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Instants as people write them. Pure. */
#ifndef HISTORY_WHEN_H
#define HISTORY_WHEN_H
#include <stdbool.h>
#include <stdint.h>

/* `2026-11-20T10:00:00.5Z`, the same with an offset (+01:00), seconds since 1970 (1793491200.25), or back from now (-90s, -30m, -8h,
   -7d, now). A date and time without a zone is refused: an hour of every autumn is there twice. */
bool when_parse(const char *text, int64_t now_us, int64_t *t_us);
#define WHEN_FORMS "an instant such as 2026-11-20T10:00:00Z (or with an offset, +01:00), seconds since 1970, or -8h"
enum { WHEN_BYTES = 32 };
void when_print(int64_t t_us, char text[WHEN_BYTES]); /* 2026-11-20T10:00:00.500Z; microseconds where there are any */

#endif
