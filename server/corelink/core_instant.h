/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Serialises the readings at a past instant, as recorded by a core, for a renderer, and parses them. Pure. Call from any thread. */
#ifndef CORELINK_CORE_INSTANT_H
#define CORELINK_CORE_INSTANT_H
#include "base/text/text.h"
#include "value/snapshot.h"

#define CORE_INSTANT_PATH "/core/instant"
enum { CORE_INSTANT_HEAD_BYTES = 16, CORE_INSTANT_READING_BYTES = 32 };

/* Appends the message with the readings. first_us: start of the core's history, 0: none. snapshot NULL: the message has only first_us. */
void core_instant_write(struct text *out, int64_t first_us, const struct snapshot *snapshot);
/* Parses a message into *snapshot, which has a reading for each tag; the snapshot's clocks stay unchanged. snapshot NULL:
 * parses only first_us. Returns NULL, or what is wrong with the message (static text). */
const char *core_instant_read(const void *bytes, size_t count, int64_t *first_us, struct snapshot *snapshot);

#endif
