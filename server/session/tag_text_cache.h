/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What was last said of tags, kept for the next who is to hear the same: many sessions hear of every change at one time. Pure. */
#ifndef SESSION_TAG_TEXT_CACHE_H
#define SESSION_TAG_TEXT_CACHE_H
#include "session/session.h"

struct tag_text_cache { /* zero-initialise */
    uint32_t *before;   /* what those knew who heard it; by tag */
    int64_t taken_ns;   /* the snapshot that it is of */
    bool all;
    char *text; /* NULL: nothing was said yet */
};

/* As reply_tags_text; said NULL: nothing is kept. mem_free. */
char *tag_text_cache_get(struct tag_text_cache *said, const struct plant *plant, const struct snapshot *snapshot, uint32_t *sent, bool all);
void tag_text_cache_finish(struct tag_text_cache *said);

#endif
