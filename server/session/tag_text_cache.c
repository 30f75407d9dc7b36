/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One text of tags for many sessions. */
#include "session/tag_text_cache.h"

#include <string.h>

#include "base/mem.h"
#include "session/reply.h"

static bool is_the_same(const struct tag_text_cache *said, const struct snapshot *snapshot, const uint32_t *sent, bool all)
{
    return said->text && said->taken_ns == snapshot->taken_mono_ns && said->all == all &&
           (all || !memcmp(said->before, sent, snapshot->count * sizeof(*sent)));
}

char *tag_text_cache_get(struct tag_text_cache *said, const struct plant *plant, const struct snapshot *snapshot, uint32_t *sent, bool all)
{
    if (!said || snapshot->count == 0)
        return reply_tags_text(plant, snapshot, sent, all);
    if (is_the_same(said, snapshot, sent, all)) {
        for (size_t i = 0; i < snapshot->count; i++)
            sent[i] = snapshot->readings[i].changes;
        return mem_strdup(said->text);
    }
    if (!said->before)
        said->before = mem_array(snapshot->count, sizeof(*said->before));
    memcpy(said->before, sent, snapshot->count * sizeof(*sent));
    said->taken_ns = snapshot->taken_mono_ns;
    said->all = all;
    mem_free(said->text);
    said->text = reply_tags_text(plant, snapshot, sent, all);
    return mem_strdup(said->text);
}

void tag_text_cache_finish(struct tag_text_cache *said)
{
    mem_free(said->before);
    mem_free(said->text);
    *said = (struct tag_text_cache){ 0 };
}
