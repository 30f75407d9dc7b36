/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds assets, groups and tags of a plant by name, and returns settings that a tag inherits from its source. */
#include <math.h>
#include <string.h>

#include "base/math/search.h"
#include "plant/plant.h"

static const char *id_of(const void *things, size_t stride, int index)
{
    return *(char *const *)((const char *)things + (size_t)index * stride);
}

/* Finds an item of the plant file by its id, by binary search. `things`: records that each begin with `char *id`; `order`:
   their indices, sorted by id. Returns an index, or -1 if there is no such record. */
static int find_sorted(const int *order, size_t count, const void *things, size_t stride, const char *id)
{
    size_t at;
    search_sorted(at, count, strcmp(id_of(things, stride, order[at]), id) < 0);
    return at < count && !strcmp(id_of(things, stride, order[at]), id) ? order[at] : -1;
}

int plant_find_asset(const struct plant *plant, const char *id)
{
    if (plant->assets_by_id)
        return find_sorted(plant->assets_by_id, plant->asset_count, plant->assets, sizeof(*plant->assets), id);
    for (size_t i = 0; i < plant->asset_count; i++)
        if (!strcmp(plant->assets[i].id, id))
            return (int)i;
    return -1;
}

int plant_find_group(const struct plant *plant, const char *id)
{
    for (size_t i = 0; i < plant->group_count; i++)
        if (!strcmp(plant->groups[i].id, id))
            return (int)i;
    return -1;
}

int plant_find_tag(const struct plant *plant, const char *name)
{
    return find_sorted(plant->tags_by_name, plant->tag_count, plant->tags, sizeof(*plant->tags), name);
}

const char *plant_tag_unit(const struct plant *plant, int tag)
{
    const char *unit = tag < 0 ? NULL : plant->tags[tag].unit;
    return unit ? unit : "";
}

int plant_tag_scan_ms(const struct plant *plant, const struct plant_tag *tag)
{
    int source_ms = tag->source >= 0 ? plant->sources[tag->source].poll_ms : 1000;
    return tag->signal.scan_ms > 0 ? tag->signal.scan_ms : source_ms;
}

bool plant_tag_sends_changes(const struct plant *plant, const struct plant_tag *tag)
{
    const struct plant_source *source = tag->source >= 0 ? &plant->sources[tag->source] : NULL;
    if (!source || !source->kind)
        return false;
    return !strcmp(source->kind, "opcua") || (!strcmp(source->kind, "mqtt") && source->mqtt.payload == MQTT_SPARKPLUG);
}

double plant_tag_default_stale_s(const struct plant *plant, const struct plant_tag *tag)
{
    return plant_tag_sends_changes(plant, tag) ? PLANT_NEVER_STALE_S : fmax(5, 3 * plant_tag_scan_ms(plant, tag) / 1000.0);
}

int plant_tag_modbus_unit(const struct plant *plant, const struct plant_tag *tag)
{
    return tag->signal.modbus_unit >= 0 ? tag->signal.modbus_unit : plant->sources[tag->source].unit;
}
