/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the plant file's `colormaps`: names and images. */
#include <string.h>

#include "base/mem.h"
#include "base/text/embedded.h"
#include "plant/plant_impl.h"
#include "plant/sections/image_ramp.h"

struct record {
    char *name, *image;
};

static bool is_taken(const struct plant *plant, const char *name)
{
    char *file = mem_printf("maps/%s.csv", name);
    bool taken = embedded_find(file) != NULL;
    mem_free(file);
    for (size_t i = 0; i + 1 < plant->display.colormap_count; i++)
        taken = taken || !strcmp(plant->display.colormaps[i].name, name);
    return taken;
}

static void read_image(struct yaml_reader *reader, const struct plant *plant, struct plant_colormap *map, const char *image,
                       struct text_position place)
{
    char why[IMAGE_WHY_BYTES], *path = *image == '/' ? mem_strdup(image) : mem_printf("%s/%s", plant->files.folder, image);
    if (!image_ramp(path, map->rgb, why))
        yaml_error(reader, place, "image: '%s': %s", path, why);
    mem_free(path);
}

static void read_colormap(struct yaml_reader *reader, yaml_node_t *node, const struct plant *plant, struct plant_colormap *map)
{
    static const struct yaml_key keys[] = {
        { "name", KEY_NAME, true, offsetof(struct record, name), 0, 0, NULL, NULL },
        { "image", KEY_NAME, true, offsetof(struct record, image), 0, 0, NULL, NULL },
        { 0 }
    };
    struct record record = { 0 };
    struct yaml_map where;
    yaml_map_read(reader, node, "a colour map", keys, &record, &where);
    map->name = record.name ? record.name : mem_strdup("");
    if (record.name && is_taken(plant, record.name))
        yaml_error(reader, yaml_map_place(&where, "name"), "name: there is a colour map '%s' already", record.name);
    if (record.image)
        read_image(reader, plant, map, record.image, yaml_map_place(&where, "image"));
    mem_free(record.image);
}

void plant_colormaps_read(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct plant *plant = record;
    int count = yaml_list_count(reader, node, "colormaps");
    if (count > PLANT_COLORMAPS)
        yaml_error(reader, yaml_place(node), "colormaps: expected at most %d, found %d", PLANT_COLORMAPS, count);
    for (int i = 0; i < count && i < PLANT_COLORMAPS; i++)
        read_colormap(reader, yaml_list_item(reader, node, i), plant, &plant->display.colormaps[plant->display.colormap_count++]);
}
