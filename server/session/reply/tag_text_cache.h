/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tag text cache: the last `tags` message, for the next session that needs the same. Many sessions are sent each change at one time.
   Thread: the loop. */
#ifndef SESSION_REPLY_TAG_TEXT_CACHE_H
#define SESSION_REPLY_TAG_TEXT_CACHE_H
#include "session/session.h"

struct tag_text_cache { /* zero-initialise */
    uint32_t *before;   /* reading.changes that its receivers had been sent, by tag */
    int64_t taken_ns;   /* of its snapshot */
    bool all;
    char *text; /* NULL: none yet */
};

/* Returns what reply_tags_text would; mem_free. cache NULL: the text is made anew. Updates `sent`. */
char *tag_text_cache_get(struct tag_text_cache *cache, const struct plant *plant, const struct snapshot *snapshot, uint32_t *sent,
                         bool all);
void tag_text_cache_finish(struct tag_text_cache *cache);

#endif
