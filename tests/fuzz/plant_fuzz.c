/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Feeds bytes to plant_load: a plant file, a line of ====, a tag list. A plant that loads must satisfy the checks of promise.h. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "plant/plant.h"
#include "plant/sensors.h"
#include "tests/support/owned.h"
#include "tests/support/temp.h"
#include "tests/fuzz/promise.h"

#define SEPARATOR "\n====\n"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static char *folder; /* one folder for all inputs */

static void check_tag(const struct plant *plant, const struct plant_tag *tag)
{
    require(tag->source >= -1 && tag->source < (int)plant->source_count, "source index");
    require(tag->group >= -1 && tag->group < (int)plant->group_count, "group index");
    require(tag->asset >= -1 && tag->asset < (int)plant->asset_count, "asset index");
    require(tag->signal.register_index >= 0 && tag->signal.register_index <= 65535 && tag->signal.bit >= -1 && tag->signal.bit <= 15,
            "register");
    require(tag->group < 0 || tag->asset < 0 || tag->place.has_position || tag->place.node, "sensor with a place");
    require(isfinite(tag->strength) && isfinite(tag->decay) && tag->validity.stale_s > 0, "numbers");
    for (int i = 0; i < 3; i++)
        require(isfinite(tag->place.position_m[i]), "position");
    require(tag->scale.kind == SCALING_NONE ||
                (tag->scale.raw_low < tag->scale.raw_high && tag->scale.scaled_low < tag->scale.scaled_high),
            "scaling");
    int found = plant_find_tag(plant, tag->name);
    require(found >= 0 && &plant->tags[found] == tag, "names are unique and found");
}

static void check_plant(const struct plant *plant)
{
    require(plant->name && plant->time_zone && plant->files.tags_path && plant->asset_count > 0 && plant->group_count > 0, "required keys");
    for (size_t i = 0; i < plant->group_count; i++)
        require(plant->groups[i].min < plant->groups[i].max, "min < max");
    for (size_t i = 0; i < plant->tag_count; i++)
        check_tag(plant, &plant->tags[i]);
    for (size_t i = 0; i < plant->asset_count; i++) {
        struct plant_sensor *sensors;
        size_t count = plant_sensors(plant, (int)i, &sensors);
        for (size_t k = 0; k < count; k++)
            require(isfinite(sensors[k].position_m[0]) && (sensors[k].node != NULL) == (sensors[k].node_hash != 0), "sensor");
        mem_free(sensors);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    const uint8_t *cut = memmem(bytes, count, SEPARATOR, strlen(SEPARATOR));
    size_t yaml_bytes = cut ? (size_t)(cut - bytes) : count;
    size_t csv_at = cut ? yaml_bytes + strlen(SEPARATOR) : count;
    struct diag diag = { 0 };
    if (!folder) {
        folder = temp_folder();
        temp_write_text(folder, "m.glb", "glTF");
    }
    size_t owned = owned_count();
    char *path = temp_write(folder, "plant.yaml", bytes, yaml_bytes);
    temp_write(folder, "tags.csv", bytes + csv_at, count - csv_at);
    struct plant *plant = plant_load(path, &diag);
    require((plant != NULL) == (diag.errors == 0), "loaded without errors, or not at all");
    if (plant)
        check_plant(plant);
    for (size_t i = 0; i < diag.count; i++)
        require(diag.items[i].line >= 0 && diag.items[i].text[0], "a finding has a text");
    FILE *nowhere = fopen("/dev/null", "w");
    diag_print(&diag, nowhere);
    fclose(nowhere);
    plant_destroy(&plant);
    diag_finish(&diag);
    owned_release(owned); /* releases the paths that this input's run created; a long run would otherwise keep those of all inputs */
    return 0;
}
