/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the tags that are sensors of an asset, and their positions in its coordinate frame. */
#include "plant/sensors.h"

#include <string.h>
#include <xxhash.h>

#include "base/mem.h"
#include "plant/models/transform.h"

static bool is_sensor(const struct plant_tag *tag, int asset)
{
    return tag->asset == asset && tag->group >= 0;
}

size_t plant_sensors(const struct plant *plant, int asset, struct plant_sensor **out)
{
    const struct plant_asset *of = &plant->assets[asset];
    size_t count = 0;
    double asset_from_plant[16];
    /* transform_invert() cannot fail here: plant_load() refuses assets whose placement has no inverse */
    if (!transform_invert(of->placement, asset_from_plant))
        memcpy(asset_from_plant, transform_identity, sizeof(asset_from_plant));
    for (size_t i = 0; i < plant->tag_count; i++)
        count += is_sensor(&plant->tags[i], asset);
    *out = mem_array(count, sizeof(**out));
    struct plant_sensor *sensor = *out;
    for (size_t i = 0; i < plant->tag_count; i++) {
        const struct plant_tag *tag = &plant->tags[i];
        if (!is_sensor(tag, asset))
            continue;
        sensor->tag = (int)i;
        if (!tag->place.has_position) {
            sensor->node = tag->place.node ? tag->place.node : "";
            sensor->node_hash = XXH3_64bits_withSeed(sensor->node, strlen(sensor->node), tag->place.assumed);
        } else {
            transform_point(of->sensors_in_asset_frame ? transform_identity : asset_from_plant, tag->place.position_m, sensor->position_m);
            if (tag->place.assumed)
                sensor->node_hash = XXH3_64bits_withSeed(sensor->position_m, sizeof(sensor->position_m), tag->place.assumed);
        }
        sensor++;
    }
    return count;
}

static bool is_placed(const struct plant_tag *tag, int group)
{
    return tag->group == group && !tag->place.assumed;
}

size_t plant_placed_sensors(const struct plant *plant, const struct plant_sensor *sensors, size_t count, int group, uint32_t *columns)
{
    size_t placed = 0;
    for (size_t i = 0; i < count; i++) {
        if (!is_placed(&plant->tags[sensors[i].tag], group))
            continue;
        if (columns)
            columns[placed] = (uint32_t)i;
        placed++;
    }
    return placed;
}

bool plant_sensor_is_alone(const struct plant *plant, const struct plant_sensor *sensors, size_t count, size_t sensor)
{
    const struct plant_tag *of = &plant->tags[sensors[sensor].tag];
    for (size_t i = 0; i < count; i++)
        if (i != sensor && is_placed(&plant->tags[sensors[i].tag], of->group))
            return false;
    return true;
}
