/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tags sorted by topic, then by path; those of one topic stand together. */
#include "value/mqtt/mqtt_topics.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

static int by_topic(const void *pa, const void *pb, void *tags_ptr)
{
    const struct plant_tag *tags = tags_ptr;
    int a = *(const int *)pa, b = *(const int *)pb;
    int order = strcmp(tags[a].topic, tags[b].topic);
    if (order == 0)
        order = strcmp(tags[a].path, tags[b].path);
    return order ? order : (a > b) - (a < b);
}

void mqtt_topics_init(struct mqtt_topics *topics, const struct plant *plant, int source)
{
    *topics = (struct mqtt_topics){ .tags = mem_array(plant->tag_count, sizeof(*topics->tags)) };
    for (size_t i = 0; i < plant->tag_count; i++)
        if (plant->tags[i].source == source)
            topics->tags[topics->tag_count++] = (int)i;
    qsort_r(topics->tags, topics->tag_count, sizeof(*topics->tags), by_topic, plant->tags);
    topics->at = mem_array(topics->tag_count, sizeof(*topics->at));
    for (size_t i = 0; i < topics->tag_count; i++) {
        const char *name = plant->tags[topics->tags[i]].topic;
        if (topics->count == 0 || strcmp(topics->at[topics->count - 1].name, name) != 0)
            topics->at[topics->count++] = (struct mqtt_topic){ .name = name, .tags = &topics->tags[i] };
        topics->at[topics->count - 1].tag_count++;
    }
}

void mqtt_topics_finish(struct mqtt_topics *topics)
{
    mem_free(topics->at);
    mem_free(topics->tags);
    *topics = (struct mqtt_topics){ 0 };
}

static int compare_name(const void *name, const void *topic)
{
    return strcmp(name, ((const struct mqtt_topic *)topic)->name);
}

const struct mqtt_topic *mqtt_topics_find(const struct mqtt_topics *topics, const char *name)
{
    return topics->count == 0 ? NULL : bsearch(name, topics->at, topics->count, sizeof(*topics->at), compare_name);
}
