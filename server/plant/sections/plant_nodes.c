/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads an asset's key `nodes`: patterns that select the model's nodes that belong to the asset. */
#include <string.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "plant/models/nodes.h"
#include "plant/plant_impl.h"

static void add_pattern(struct yaml_reader *reader, const yaml_node_t *node, struct text *patterns)
{
    const char *text = yaml_text(node);
    if (!text || !*text || yaml_is_null(node)) {
        yaml_expected(reader, node, "nodes", "a node's name or a pattern (with # or ! in quotes, such as \"#12\")");
        return;
    }
    if (strlen(text) != node->data.scalar.length || strchr(text, NODES_SEPARATOR)) {
        yaml_error(reader, yaml_place(node), "nodes: contains a line break or a NUL character");
        return;
    }
    text_add(patterns, "%s%s", patterns->length ? (char[]){ NODES_SEPARATOR, 0 } : "", text);
}

void plant_nodes_read(struct yaml_reader *reader, yaml_node_t *node, struct plant_asset *asset)
{
    struct text patterns = { 0 };
    if (node->type == YAML_MAPPING_NODE) {
        yaml_expected(reader, node, "nodes", "a name, a pattern, or a list of names and patterns");
    } else if (node->type != YAML_SEQUENCE_NODE) {
        add_pattern(reader, node, &patterns);
    } else {
        int count = yaml_list_count(reader, node, "nodes");
        if (count == 0)
            yaml_expected(reader, node, "nodes", "at least one pattern");
        for (int i = 0; i < count; i++)
            add_pattern(reader, yaml_list_item(reader, node, i), &patterns);
    }
    if (patterns.length)
        asset->nodes = mem_strdup(patterns.at);
    text_finish(&patterns);
}
