/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The topics of an MQTT source, sorted, with the tags of each topic. Immutable once made. Call from any thread. */
#ifndef VALUE_MQTT_TOPICS_H
#define VALUE_MQTT_TOPICS_H
#include <stddef.h>

#include "plant/plant.h"

struct mqtt_topic {
    const char *name; /* name of the topic; the plant owns the text */
    const int *tags;  /* indices in plant->tags of the topic's tags, sorted by path */
    size_t tag_count;
};

struct mqtt_topics {
    struct mqtt_topic *at;
    size_t count;
    int *tags; /* indices in plant->tags of the source's tags, grouped by topic */
    size_t tag_count;
};

/* Builds the topics of one source. `plant` must outlive them. */
void mqtt_topics_init(struct mqtt_topics *topics, const struct plant *plant, int source);
void mqtt_topics_finish(struct mqtt_topics *topics);
/* Finds a topic of the source by its name. Returns NULL if the source has no such topic. */
const struct mqtt_topic *mqtt_topics_find(const struct mqtt_topics *topics, const char *name);

#endif
