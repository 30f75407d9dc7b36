/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Caches the last `tags` message (changed readings), so that its text is built once for all sessions that need the same
   changes. */
#include "session/reply/tag_text_cache.h"

#include <string.h>

#include "base/mem.h"
#include "session/reply/reply.h"

static bool is_the_same(const struct tag_text_cache *cache, const struct snapshot *snapshot, const uint32_t *sent, bool all)
{
    return cache->text && cache->taken_ns == snapshot->taken_mono_ns && cache->all == all &&
           (all || !memcmp(cache->before, sent, snapshot->count * sizeof(*sent)));
}

char *tag_text_cache_get(struct tag_text_cache *cache, const struct plant *plant, const struct snapshot *snapshot, uint32_t *sent, bool all)
{
    if (!cache || snapshot->count == 0)
        return reply_tags_text(plant, snapshot, sent, all);
    if (is_the_same(cache, snapshot, sent, all)) {
        for (size_t i = 0; i < snapshot->count; i++)
            sent[i] = snapshot->readings[i].changes;
        return mem_strdup(cache->text);
    }
    if (!cache->before)
        cache->before = mem_array(snapshot->count, sizeof(*cache->before));
    memcpy(cache->before, sent, snapshot->count * sizeof(*sent));
    cache->taken_ns = snapshot->taken_mono_ns;
    cache->all = all;
    mem_free(cache->text);
    cache->text = reply_tags_text(plant, snapshot, sent, all);
    return mem_strdup(cache->text);
}

void tag_text_cache_finish(struct tag_text_cache *cache)
{
    mem_free(cache->before);
    mem_free(cache->text);
    *cache = (struct tag_text_cache){ 0 };
}
