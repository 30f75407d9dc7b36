/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Groups the tags of an OPC UA source by node: sorts them by node, then by array element. */
#include "value/opcua/opcua_nodes.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "value/source_tags.h"

/* Returns the deadband of a tag: from the tag list or, if that has none, from its source. */
static struct opcua_deadband deadband_of(const struct plant_opcua *source, const struct plant_tag *tag)
{
    if (!isnan(tag->signal.opcua_deadband.value))
        return tag->signal.opcua_deadband;
    bool percent = source->deadband_percent > 0;
    return (struct opcua_deadband){ percent ? source->deadband_percent : source->deadband, percent };
}

static void take_deadband(struct opcua_node *node, const struct plant_opcua *source, const struct plant_tag *tag)
{
    struct opcua_deadband deadband = deadband_of(source, tag);
    bool is_first = node->tag_count == 0, differs = deadband.percent != node->deadband.percent;
    if (is_first || (!differs && deadband.value < node->deadband.value))
        node->deadband = deadband;
    else if (differs)
        node->deadband.value = 0;
    node->own_deadband |= !isnan(tag->signal.opcua_deadband.value);
}

void opcua_nodes_init(struct opcua_nodes *nodes, const struct plant *plant, int source)
{
    *nodes = (struct opcua_nodes){ 0 };
    nodes->tags = source_tags_by_topic(plant, source, &nodes->tag_count);
    nodes->at = mem_array(nodes->tag_count, sizeof(*nodes->at));
    for (size_t i = 0; i < nodes->tag_count; i++) {
        const struct plant_tag *tag = &plant->tags[nodes->tags[i]];
        int sampling_ms = plant_tag_scan_ms(plant, tag);
        struct opcua_node *node = nodes->count > 0 ? &nodes->at[nodes->count - 1] : NULL;
        if (!node || strcmp(node->name_space, tag->signal.topic) != 0 || strcmp(node->id, tag->signal.path) != 0) {
            node = &nodes->at[nodes->count++];
            *node = (struct opcua_node){
                .name_space = tag->signal.topic, .id = tag->signal.path, .tags = &nodes->tags[i], .sampling_ms = sampling_ms
            };
        }
        take_deadband(node, &plant->sources[source].opcua, tag);
        node->tag_count++;
        node->sampling_ms = sampling_ms < node->sampling_ms ? sampling_ms : node->sampling_ms;
    }
}

void opcua_nodes_finish(struct opcua_nodes *nodes)
{
    mem_free(nodes->at);
    mem_free(nodes->tags);
    *nodes = (struct opcua_nodes){ 0 };
}
