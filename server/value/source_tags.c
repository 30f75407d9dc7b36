/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists the tags of a source by their addresses; tags with equal addresses stay in the order of the tag list. */
#include "value/source_tags.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

static int by_topic(const void *pa, const void *pb, void *tags_ptr)
{
    const struct plant_tag *tags = tags_ptr;
    int a = *(const int *)pa, b = *(const int *)pb;
    int order = strcmp(tags[a].signal.topic, tags[b].signal.topic);
    if (order == 0)
        order = strcmp(tags[a].signal.path, tags[b].signal.path);
    return order ? order : (a > b) - (a < b);
}

int *source_tags_by_topic(const struct plant *plant, int source, size_t *count)
{
    int *tags = mem_array(plant->tag_count, sizeof(*tags));
    *count = 0;
    for (size_t i = 0; i < plant->tag_count; i++)
        if (plant->tags[i].source == source)
            tags[(*count)++] = (int)i;
    qsort_r(tags, *count, sizeof(*tags), by_topic, plant->tags);
    return tags;
}
