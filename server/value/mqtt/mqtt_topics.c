/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Groups the tags of an MQTT source by topic: sorts them by topic, then by path. */
#include "value/mqtt/mqtt_topics.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "value/source_tags.h"

void mqtt_topics_init(struct mqtt_topics *topics, const struct plant *plant, int source)
{
    *topics = (struct mqtt_topics){ 0 };
    topics->tags = source_tags_by_topic(plant, source, &topics->tag_count);
    topics->at = mem_array(topics->tag_count, sizeof(*topics->at));
    for (size_t i = 0; i < topics->tag_count; i++) {
        const char *name = plant->tags[topics->tags[i]].signal.topic;
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
