/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the plant file's `environment`: panorama images. Opens each image to report errors with a position in the plant file. */
#include <string.h>

#include "base/image/image.h"
#include "base/mem.h"
#include "plant/plant_impl.h"

static char *name_of(const char *path)
{
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
    return mem_printf("%.*s", (int)(dot && dot > name ? (size_t)(dot - name) : strlen(name)), name);
}

static void read_one(struct yaml_reader *reader, yaml_node_t *node, struct plant *plant)
{
    struct plant_environment *environment = &plant->display.environments[plant->display.environment_count];
    struct image_float image;
    char why[IMAGE_WHY_BYTES];
    const char *text = yaml_text(node);
    if (!text || !*text) {
        yaml_expected(reader, node, "environment", "the path of a picture");
        return;
    }
    char *path = *text == '/' ? mem_strdup(text) : mem_printf("%s/%s", plant->files.folder, text), *name = name_of(path);
    if (!strcmp(name, "sky") || plant_find_environment(plant, name) >= 0)
        yaml_error(reader, yaml_place(node), "environment: the name '%s' is already used", name);
    else if (!image_load_float(&image, path, 16, why))
        yaml_error(reader, yaml_place(node), "environment: '%s': %s", path, why);
    else {
        mem_free(image.rgba);
        *environment = (struct plant_environment){ .name = name, .path = path };
        plant->display.environment_count++;
        return;
    }
    mem_free(path);
    mem_free(name);
}

void plant_environments_read(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct plant *plant = record;
    if (node->type != YAML_SEQUENCE_NODE) {
        read_one(reader, node, plant);
        return;
    }
    int count = yaml_list_count(reader, node, "environment");
    if (count > PLANT_ENVIRONMENTS)
        yaml_error(reader, yaml_place(node), "environment: expected at most %d pictures, found %d", PLANT_ENVIRONMENTS, count);
    for (int i = 0; i < count && i < PLANT_ENVIRONMENTS; i++)
        read_one(reader, yaml_list_item(reader, node, i), plant);
}

int plant_find_environment(const struct plant *plant, const char *name)
{
    if (!strcmp(name, "sky"))
        return 0;
    for (size_t i = 0; i < plant->display.environment_count; i++)
        if (!strcmp(plant->display.environments[i].name, name))
            return (int)i + 1;
    return -1;
}
