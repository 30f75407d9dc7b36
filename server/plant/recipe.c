/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes hashes of the model and the settings that determine an asset file of plantcast-prep. */
#include "plant/recipe.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <xxhash.h>

#include "base/mem.h"
#include "plant/exact.h"
#include "plant/influence.h"
#include "plant/singles.h"

enum { CHUNK_BYTES = 1 << 20 };

bool plant_model_hash(const char *path, uint64_t *out)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return false;
    XXH3_state_t *state = XXH3_createState();
    char *chunk = mem_array(CHUNK_BYTES, 1);
    XXH3_64bits_reset(state);
    for (size_t got; (got = fread(chunk, 1, CHUNK_BYTES, file)) > 0;)
        XXH3_64bits_update(state, chunk, got);
    int cause = ferror(file) ? errno : 0;
    *out = XXH3_64bits_digest(state);
    XXH3_freeState(state);
    mem_free(chunk);
    fclose(file);
    errno = cause;
    return cause == 0;
}

uint64_t plant_recipe(const struct plant_asset *asset, uint64_t model_hash)
{
    struct { /* without padding */
        uint64_t model, nodes, whole_model, up;
        double unit_m, tolerance_m;
    } recipe = {
        .model = model_hash,
        .nodes = asset->nodes ? XXH3_64bits(asset->nodes, strlen(asset->nodes)) : 0,
        .whole_model = !asset->nodes,
        .up = (uint64_t)asset->up,
        .unit_m = asset->unit_m,
        .tolerance_m = asset->tolerance_m,
    };
    return XXH3_64bits(&recipe, sizeof(recipe));
}

/* Returns the hash of the parameters of one sensor and its group, and of `before`: the hash of the sensors before it. */
static uint64_t cuts_recipe_of(const struct plant *plant, const struct plant_sensor *sensors, size_t count, size_t sensor, uint64_t before)
{
    const struct plant_tag *tag = &plant->tags[sensors[sensor].tag];
    const struct plant_group *group = &plant->groups[tag->group];
    /* no triangles are cut for the value of a group whose field is evaluated at each pixel */
    const bool cuts = !plant_group_is_exact(group), prepares = plant_prepares_any(group);
    struct { /* without padding */
        double group, strength, decay, power, radius_m, reach_m, prepared, disc_m, decay_m;
        uint64_t flags;
    } recipe = {
        .group = tag->group,
        .strength = cuts ? tag->strength : 0,
        .decay = cuts ? tag->decay : 0,
        .power = cuts ? group->power : 0,
        .radius_m = cuts ? group->radius_m : 0,
        .reach_m = cuts ? group->reach_m : 0,
        .prepared = prepares ? group->prepared : 0,
        .disc_m = prepares ? group->disc_m : 0,
        .decay_m = plant_prepares(group, INTERPOLATION_FIN) ? plant_decay_m(&plant->assets[tag->asset]) : 0,
        .flags = (uint64_t)group->heat | (uint64_t)group->directed << 1 | (uint64_t)cuts << 2 | (uint64_t)tag->place.assumed << 3 |
                 (uint64_t)(cuts && !plant_cuts_for_paper(group, 1) && plant_sensor_is_alone(plant, sensors, count, sensor)) << 4,
    };
    return XXH3_64bits_withSeed(&recipe, sizeof(recipe), before);
}

uint64_t plant_cuts_recipe(const struct plant *plant, const struct plant_sensor *sensors, size_t count)
{
    uint64_t hash = 0;
    for (size_t i = 0; i < count; i++)
        hash = cuts_recipe_of(plant, sensors, count, i, hash);
    return hash;
}
