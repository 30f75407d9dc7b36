/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the plant file's `other_plants`: servers of other plants, whose pictures appear in panes of wall displays. */
#include <string.h>

#include "base/mem.h"
#include "plant/plant_impl.h"
#include "plant/sources/url.h"
#include "plant/walls/wall.h"

static void check(struct yaml_reader *reader, const struct yaml_map *map, const struct plant *plant, struct other_plant *other)
{
    plant_secret_check(reader, map, plant, "token_file", &other->token_file);
    plant_secret_check(reader, map, plant, "ca_file", &other->ca_file);
    url_check(reader, map, "url", other->url, "http://", "https://");
    url_check_token(reader, map, other->url);
    if (other->url && strpbrk(other->url, "?#"))
        yaml_error(reader, yaml_map_place(map, "url"), "url: expected the server's address without '?' and '#'");
    if (other->id && !named_view_id_valid(other->id))
        yaml_error(reader, yaml_map_place(map, "id"), "id: expected letters, digits, '_', '-' and '.', found '%.60s'", other->id);
    if (other->view && !named_view_id_valid(other->view))
        yaml_error(reader, yaml_map_place(map, "view"), "view: expected the id of one of the other server's `views`, found '%.60s'",
                   other->view);
}

void plant_other_plants_read(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct plant *plant = record;
    static const struct yaml_key keys[] = { { "id", KEY_NAME, true, offsetof(struct other_plant, id), 0, 0, NULL, NULL },
                                            { "url", KEY_NAME, true, offsetof(struct other_plant, url), 0, 0, NULL, NULL },
                                            { "token_file", KEY_NAME, false, offsetof(struct other_plant, token_file), 0, 0, NULL, NULL },
                                            { "ca_file", KEY_NAME, false, offsetof(struct other_plant, ca_file), 0, 0, NULL, NULL },
                                            { "view", KEY_NAME, false, offsetof(struct other_plant, view), 0, 0, NULL, NULL },
                                            { "every_s", KEY_NUMBER, false, offsetof(struct other_plant, every_s), 2, 3600, NULL, NULL },
                                            { "width", KEY_INT, false, offsetof(struct other_plant, width_px), 256, 3840, NULL, NULL },
                                            { "height", KEY_INT, false, offsetof(struct other_plant, height_px), 144, 2160, NULL, NULL },
                                            { 0 } };
    int count;
    plant->screens.other_plants =
        plant_list_make(reader, node, "other_plants", 0, OTHER_PLANTS, sizeof(*plant->screens.other_plants), &count);
    for (int i = 0; i < count; i++) {
        struct other_plant *other = &plant->screens.other_plants[plant->screens.other_plant_count++];
        yaml_node_t *item = yaml_list_item(reader, node, i);
        struct yaml_map map;
        *other = (struct other_plant){ .every_s = 5, .width_px = 1280, .height_px = 720, .line = yaml_place(item).line };
        if (!yaml_map_read(reader, item, "another plant", keys, other, &map))
            continue;
        check(reader, &map, plant, other);
        plant_list_check_id(reader, &map, "plant", plant->screens.other_plants, plant->screens.other_plant_count, sizeof(*other),
                            offsetof(struct other_plant, line));
    }
}

int other_plant_find(const struct plant *plant, const char *id)
{
    for (size_t i = 0; i < plant->screens.other_plant_count; i++)
        if (!strcmp(plant->screens.other_plants[i].id, id))
            return (int)i;
    return -1;
}

void plant_other_plants_free(struct plant *plant)
{
    for (size_t i = 0; i < plant->screens.other_plant_count; i++) {
        struct other_plant *other = &plant->screens.other_plants[i];
        mem_free(other->id);
        mem_free(other->url);
        mem_free(other->token_file);
        mem_free(other->ca_file);
        mem_free(other->view);
    }
    mem_free(plant->screens.other_plants);
}
