/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists the sensors of an asset as its asset file must have them: plantcast-prep writes this list, and scene_create() compares
   the file with it. Call from any thread. */
#ifndef PLANT_SENSORS_H
#define PLANT_SENSORS_H
#include <stdint.h>

#include "plant/plant.h"

struct plant_sensor {
    int tag; /* index in plant->tags */
    /* name of the model node that gives the position; "": the middle of the asset; NULL: position_m is used. The plant owns the text */
    const char *node;
    /* 0: position_m gives the position. Otherwise the hash (XXH3-64) of `node`. If the sensor's place is assumed, the hash of
       `node` or position_m, computed with another seed, so that it differs from that of a known place */
    uint64_t node_hash;
    double position_m[3]; /* position in the asset's coordinate frame (metres, Z up); zero if `node` is set */
};

/* Lists the tags that have this asset and a group, in the order of the tag list; free *out with mem_free(). Returns their number. */
size_t plant_sensors(const struct plant *plant, int asset, struct plant_sensor **out);
/* Finds the sensors of a group whose place is known, and writes their indices to columns, which has room for `count`; NULL: only counts
   them. Returns their number. Weights in an influence file are in this order. */
size_t plant_placed_sensors(const struct plant *plant, const struct plant_sensor *sensors, size_t count, int group, uint32_t *columns);
/* Returns whether the asset has no other sensor of the same group as sensor number `sensor`. Sensors with an assumed place do not
   count. */
bool plant_sensor_is_alone(const struct plant *plant, const struct plant_sensor *sensors, size_t count, size_t sensor);

#endif
