/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads an asset's key `properties` in the plant file: names and values that engineers define for the asset. */
#include <string.h>

#include "base/mem.h"
#include "plant/plant_impl.h"

enum { NAME_BYTES = 63, TEXT_BYTES = 400 };

static bool is_taken(const struct plant_asset *asset, const char *name)
{
    for (size_t i = 0; i < asset->property_count; i++)
        if (!strcmp(asset->properties[i].name, name))
            return true;
    return false;
}

static void read_one(struct yaml_reader *reader, const yaml_node_t *name_node, const yaml_node_t *node, struct plant_asset *asset)
{
    const char *name = yaml_text(name_node), *text = yaml_text(node);
    if (!name || !*name || strlen(name) > NAME_BYTES)
        yaml_error(reader, yaml_place(name_node), "properties: expected a name of 1 to %d bytes", NAME_BYTES);
    else if (!text)
        yaml_expected(reader, node, name, "text or a number");
    else if (strlen(text) > TEXT_BYTES)
        yaml_error(reader, yaml_place(node), "%s: expected at most %d bytes, found %zu", name, TEXT_BYTES, strlen(text));
    else if (is_taken(asset, name))
        yaml_error(reader, yaml_place(name_node), "properties: '%s' is listed twice", name);
    else if (!yaml_is_null(node))
        asset->properties[asset->property_count++] = (struct plant_property){ mem_strdup(name), mem_strdup(text) };
}

void plant_properties_read(struct yaml_reader *reader, yaml_node_t *node, struct plant_asset *asset)
{
    if (node->type != YAML_MAPPING_NODE) {
        yaml_expected(reader, node, "properties", "a mapping (name: text)");
        return;
    }
    const yaml_node_pair_t *first = node->data.mapping.pairs.start, *end = node->data.mapping.pairs.top;
    if (end - first > PLANT_PROPERTIES) {
        yaml_error(reader, yaml_place(node), "properties: expected at most %d, found %td", PLANT_PROPERTIES, end - first);
        return;
    }
    asset->properties = mem_array((size_t)(end - first), sizeof(*asset->properties));
    for (const yaml_node_pair_t *pair = first; pair < end; pair++)
        read_one(reader, yaml_document_get_node(&reader->doc, pair->key), yaml_document_get_node(&reader->doc, pair->value), asset);
}

void plant_properties_free(struct plant_asset *asset)
{
    for (size_t i = 0; i < asset->property_count; i++) {
        mem_free(asset->properties[i].name);
        mem_free(asset->properties[i].text);
    }
    mem_free(asset->properties);
}

bool plant_properties_same(const struct plant_asset *a, const struct plant_asset *b)
{
    bool same = a->property_count == b->property_count;
    for (size_t i = 0; same && i < a->property_count; i++)
        same = !strcmp(a->properties[i].name, b->properties[i].name) && !strcmp(a->properties[i].text, b->properties[i].text);
    return same;
}
