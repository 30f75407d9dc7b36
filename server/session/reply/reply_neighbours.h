/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the others say of each sensor, as the API says it (PROTOCOL.md, /api/v1/neighbours). Thread: the loop. */
#ifndef SESSION_REPLY_REPLY_NEIGHBOURS_H
#define SESSION_REPLY_REPLY_NEIGHBOURS_H
#include "field/neighbours.h"
#include "session/session_context.h"

struct neighbour_text_cache { /* zero-initialise; of one plant */
    struct neighbours_cache found;
};

/* Returns the sensors of the group, those that disagree most first; tag: of that one alone; -1: of all. The caller frees it. */
char *neighbour_text(struct neighbour_text_cache *cache, const struct session_context *context, int group, int tag);
/* Frees what is kept; leaves an empty cache. */
void neighbour_text_cache_finish(struct neighbour_text_cache *cache);

#endif
