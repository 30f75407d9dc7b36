/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cache of the last `tags` message. Many sessions are sent the same change at the same time, so the next session can reuse the
   text. Call only in the event loop. */
#ifndef SESSION_REPLY_TAG_TEXT_CACHE_H
#define SESSION_REPLY_TAG_TEXT_CACHE_H
#include "session/session.h"

struct tag_text_cache { /* zero-initialise */
    /* [tag]: change counter (reading.changes) of the reading that a client was sent last. The cached text is right only for
       clients for which all these counters are equal */
    uint32_t *before;
    int64_t taken_ns; /* time of the snapshot of readings that `text` lists */
    bool all;
    char *text; /* JSON text of the last `tags` message; NULL: none was built yet */
};

/* Returns the same text as reply_tags_text(); the caller frees it with mem_free. cache NULL: nothing is cached. Updates `sent`. */
char *tag_text_cache_get(struct tag_text_cache *cache, const struct plant *plant, const struct snapshot *snapshot, uint32_t *sent,
                         bool all);
void tag_text_cache_finish(struct tag_text_cache *cache);

#endif
