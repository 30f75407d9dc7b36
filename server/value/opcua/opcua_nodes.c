/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Groups tags by node: sorts them by node, then by array element. */
#include "value/opcua/opcua_nodes.h"

#include <string.h>

#include "base/mem.h"
#include "value/source_tags.h"

void opcua_nodes_init(struct opcua_nodes *nodes, const struct plant *plant, int source)
{
    *nodes = (struct opcua_nodes){ 0 };
    nodes->tags = source_tags_by_topic(plant, source, &nodes->tag_count);
    nodes->at = mem_array(nodes->tag_count, sizeof(*nodes->at));
    for (size_t i = 0; i < nodes->tag_count; i++) {
        const struct plant_tag *tag = &plant->tags[nodes->tags[i]];
        int sampling_ms = tag->signal.scan_ms ? tag->signal.scan_ms : plant->sources[source].poll_ms;
        struct opcua_node *node = nodes->count > 0 ? &nodes->at[nodes->count - 1] : NULL;
        if (!node || strcmp(node->name_space, tag->signal.topic) != 0 || strcmp(node->id, tag->signal.path) != 0) {
            node = &nodes->at[nodes->count++];
            *node = (struct opcua_node){
                .name_space = tag->signal.topic, .id = tag->signal.path, .tags = &nodes->tags[i], .sampling_ms = sampling_ms
            };
        }
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
