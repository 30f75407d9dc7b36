/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the plant file's `colormaps`: names of colour maps, and the images that they are made from. */
#include "plant/colormaps.h"

#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "plant/plant_impl.h"
#include "plant/sections/image_ramp.h"

struct record {
    char *name, *image;
};

size_t colormap_count(const struct plant *plant)
{
    return COLORMAPS_BUILT_IN + (plant ? plant->display.colormap_count : 0);
}

const struct colormap *colormap_at(const struct plant *plant, size_t index)
{
    return index < COLORMAPS_BUILT_IN ? &colormaps_built_in[index] : &plant->display.colormaps[index - COLORMAPS_BUILT_IN];
}

int colormap_find(const struct plant *plant, const char *name)
{
    for (size_t i = 0; i < colormap_count(plant); i++)
        if (!strcmp(colormap_at(plant, i)->name, name))
            return (int)i;
    return -1;
}

bool colormap_add(struct plant *plant, const char *name, const uint8_t rgb[256][3])
{
    if (plant->display.colormap_count == PLANT_COLORMAPS)
        return false;
    struct colormap *map = &plant->display.colormaps[plant->display.colormap_count++];
    snprintf(map->name, sizeof(map->name), "%s", name);
    memcpy(map->rgb, rgb, sizeof(map->rgb));
    colormap_complete(map);
    return true;
}

static void read_image(struct yaml_reader *reader, const struct plant *plant, uint8_t rgb[256][3], const char *image,
                       struct text_position place)
{
    char why[IMAGE_WHY_BYTES], *path = *image == '/' ? mem_strdup(image) : mem_printf("%s/%s", plant->files.folder, image);
    if (!image_ramp(path, rgb, why))
        yaml_error(reader, place, "image: '%s': %s", path, why);
    mem_free(path);
}

static void read_colormap(struct yaml_reader *reader, yaml_node_t *node, struct plant *plant)
{
    static const struct yaml_key keys[] = {
        { "name", KEY_NAME, true, offsetof(struct record, name), 0, 0, NULL, NULL },
        { "image", KEY_NAME, true, offsetof(struct record, image), 0, 0, NULL, NULL },
        { 0 }
    };
    struct record record = { 0 };
    struct yaml_map where;
    uint8_t rgb[256][3] = { 0 };
    yaml_map_read(reader, node, "a colour map", keys, &record, &where);
    if (record.name && colormap_find(plant, record.name) >= 0)
        yaml_error(reader, yaml_map_place(&where, "name"), "name: there is a colour map '%s' already", record.name);
    if (record.image)
        read_image(reader, plant, rgb, record.image, yaml_map_place(&where, "image"));
    colormap_add(plant, record.name ? record.name : "", (const uint8_t(*)[3])rgb);
    mem_free(record.name);
    mem_free(record.image);
}

void plant_colormaps_read(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct plant *plant = record;
    int count = plant_list_count(reader, node, "colormaps", PLANT_COLORMAPS);
    for (int i = 0; i < count; i++)
        read_colormap(reader, yaml_list_item(reader, node, i), plant);
}
