/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares each sensor with the estimate from its neighbours, for the API (HTTP.md, /api/v1/neighbours). Call only in the event loop. */
#ifndef SESSION_REPLY_REPLY_NEIGHBOURS_H
#define SESSION_REPLY_REPLY_NEIGHBOURS_H
#include "field/neighbours.h"
#include "session/session_context.h"

struct neighbour_text_cache { /* cache for neighbour_text(); zero-initialise; each cache serves one plant only */
    struct neighbours_cache found;
};

/* Returns the sensors of a group as JSON text, those that differ most from their neighbours' estimate first. tag: only that
   sensor; -1: all. The caller frees the text. */
char *neighbour_text(struct neighbour_text_cache *cache, const struct session_context *context, int group, int tag);
/* Frees the contents of the cache; the empty cache can be used again. */
void neighbour_text_cache_finish(struct neighbour_text_cache *cache);

#endif
