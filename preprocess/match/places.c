/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds positions for tags on their equipment: at an end or nozzle named in words (inlet, top), or spread along the equipment. */
#include "preprocess/match/places.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "plant/models/transform.h"
#include "preprocess/match/name_tokens.h"

/* words for an end of equipment in descriptions and node names, such as inlet */
static const struct {
    const char *word;
    int end;
} ends[] = {
    { "INLET", 1 },  { "IN", 1 },       { "INLETS", 1 },  { "ENTRY", 1 },     { "SUCTION", 1 },  { "SUCT", 1 },   { "입구", 1 },
    { "OUTLET", 2 }, { "OUT", 2 },      { "EXIT", 2 },    { "DISCHARGE", 2 }, { "DISCH", 2 },    { "출구", 2 },   { "TOP", 3 },
    { "HEAD", 3 },   { "OVERHEAD", 3 }, { "UPPER", 3 },   { "상부", 3 },      { "BOTTOM", 4 },   { "SUMP", 4 },   { "LOWER", 4 },
    { "하부", 4 },   { "SHELL", 5 },    { "TUBE", 6 },    { "TUBES", 6 },     { "NDE", 7 },      { "DE", 8 },     { "DRAIN", 9 },
    { "VENT", 10 },  { "WELL", 11 },    { "JACKET", 12 }, { "SEAL", 13 },     { "GEARBOX", 14 }, { "MOTOR", 15 },
};
enum { TOP = 3, BOTTOM = 4 };

static unsigned ends_of(const char *text)
{
    struct name_tokens tokens;
    unsigned found = 0;
    name_tokens_read(&tokens, text);
    for (int i = 0; i < tokens.count; i++)
        for (size_t k = 0; k < sizeof(ends) / sizeof(*ends); k++)
            if (!strcmp(ends[k].word, tokens.at[i].text))
                found |= 1u << ends[k].end;
    return found;
}

static unsigned ends_of_node(const struct model_tree *tree, int node)
{
    unsigned found = model_index_is_made_up(tree->nodes[node].name) ? 0 : ends_of(tree->nodes[node].name);
    for (size_t i = 0; i < tree->more[node].attribute_count; i++)
        if (!strcmp(tree->more[node].attributes[i].name, "Description") || !strcmp(tree->more[node].attributes[i].name, "Function"))
            found |= ends_of(tree->more[node].attributes[i].value);
    return found;
}

static bool shows(const struct model_tree *tree, int node)
{
    return tree->more[node].low[0] <= tree->more[node].high[0];
}

/* Returns the index of the asset's node whose name mentions the most of the `wanted` ends, such as inlet (bit mask); -1 if no node
 * or several nodes do. */
static int find_end(const struct model_index *site, int asset, unsigned wanted)
{
    const struct indexed_asset *of = &site->assets[asset];
    const struct model_tree *tree = &site->models[of->model];
    int best = -1, most = 0, alike = 0;
    for (size_t i = 0; i < tree->count && wanted; i++) {
        if (site->asset_of[of->model][i] != asset || (int)i == of->root || !shows(tree, (int)i))
            continue;
        int common = __builtin_popcount(ends_of_node(tree, (int)i) & wanted);
        alike = common > most ? 1 : common == most && common > 0 && !(best >= 0 && i < tree->nodes[best].end) ? alike + 1 : alike;
        if (common > most) {
            most = common;
            best = (int)i;
        }
    }
    return alike == 1 ? best : -1;
}

/* Transforms a point from the model's frame to the frame of the tag list's coordinates. */
static void into_list(const struct model_index *site, int asset, const double model[3], double out[3])
{
    const struct plant_asset *of = &site->plant->assets[asset];
    double m[3] = { model[0] * of->unit_m, model[1] * of->unit_m, model[2] * of->unit_m };
    double upright[3] = { m[0], of->up == AXIS_Y ? -m[2] : m[1], of->up == AXIS_Y ? m[1] : m[2] };
    if (of->sensors_in_asset_frame)
        memcpy(out, upright, sizeof(upright));
    else
        transform_point(of->placement, upright, out);
    for (int axis = 0; axis < 3; axis++)
        out[axis] = round(out[axis] * 1000) / 1000 + 0.0;
}

static void middle_of(const struct tree_node *node, double out[3])
{
    for (int axis = 0; axis < 3; axis++)
        out[axis] = (node->low[axis] + node->high[axis]) / 2;
}

static void put(const struct model_index *site, int asset, int node, const double aim[3], struct place_proposal *out)
{
    const struct model_tree *tree = &site->models[site->assets[asset].model];
    double at[3];
    if (!model_tree_nearest_vertex(tree, node, aim, at))
        memcpy(at, aim, sizeof(at));
    into_list(site, asset, at, out->position_m);
    out->has_position = true;
}

/* Computes the position of tag `number` of `count` tags without a given position on an asset: the vertex nearest to a point
 * along the equipment's longest side, or at its top or bottom. */
static void spread(const struct model_index *site, int asset, unsigned wanted, size_t number, size_t count, struct place_proposal *out)
{
    const struct indexed_asset *of = &site->assets[asset];
    const struct model_tree *tree = &site->models[of->model];
    int node = of->root < 0 ? 0 : of->root, up = site->plant->assets[asset].up == AXIS_Y ? 1 : 2, along = 0;
    const struct tree_node *box = &tree->more[node];
    double aim[3];
    out->kind = PLACE_SPREAD;
    if (!shows(tree, node))
        return;
    middle_of(box, aim);
    for (int axis = 1; axis < 3; axis++)
        if (box->high[axis] - box->low[axis] > box->high[along] - box->low[along])
            along = axis;
    aim[along] = box->low[along] + (box->high[along] - box->low[along]) * ((double)number + 0.5) / (double)count;
    if (wanted & 1u << TOP)
        aim[up] = box->high[up];
    else if (wanted & 1u << BOTTOM)
        aim[up] = box->low[up];
    put(site, asset, node, aim, out);
}

struct place_proposal *places_find(const struct model_index *site, const struct tag_export *list, const struct match *matches,
                                   const struct quantities *quantities)
{
    struct place_proposal *places = mem_array(list->count, sizeof(*places));
    size_t *counts = mem_array(site->plant->asset_count, sizeof(*counts)), *numbers = mem_array(site->plant->asset_count, sizeof(*numbers));
    for (size_t i = 0; i < list->count; i++) {
        const struct match *match = &matches[i];
        struct place_proposal *place = &places[i];
        place->node = -1;
        if (match->status != MATCH_SURE || quantities->of_tag[i] < 0)
            continue;
        const struct model_tree *tree = &site->models[site->assets[match->asset].model];
        if (match->node >= 0 && shows(tree, match->node)) {
            place->node = match->node;
            place->kind = match->confidence > 0.98 ? PLACE_OWN_NODE : PLACE_AT_NODE;
        } else {
            place->node = find_end(site, match->asset, ends_of(list->tags[i].fields[EXPORT_DESCRIPTION]));
            place->kind = place->node >= 0 ? PLACE_AT_NODE : PLACE_SPREAD;
        }
        counts[match->asset] += place->kind == PLACE_SPREAD;
    }
    for (size_t i = 0; i < list->count; i++) {
        int asset = matches[i].asset;
        if (places[i].kind == PLACE_SPREAD) {
            spread(site, asset, ends_of(list->tags[i].fields[EXPORT_DESCRIPTION]), numbers[asset], counts[asset], &places[i]);
            numbers[asset]++;
        } else if (places[i].kind == PLACE_AT_NODE) {
            double aim[3];
            middle_of(&site->models[site->assets[asset].model].more[places[i].node], aim);
            put(site, asset, places[i].node, aim, &places[i]);
        }
    }
    mem_free(counts);
    mem_free(numbers);
    return places;
}
