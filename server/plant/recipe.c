/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes hashes of the model and the settings that determine an asset file of plantcast-prep. */
#include "plant/recipe.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <xxhash.h>

#include "base/mem.h"

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
