/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds assets, groups and tags of a plant by name. */
#include <string.h>

#include "base/math/search.h"
#include "plant/plant.h"

static const char *id_of(const void *things, size_t stride, int index)
{
    return *(char *const *)((const char *)things + (size_t)index * stride);
}

/* Finds an item of the plant file (`things`) by its id, by binary search. Each record begins with `char *id`; `order` holds the records'
   indices, sorted by id. Returns an index, or -1 if there is no such record. */
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
