/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the plant file's `convert`: models that plantcast-prep makes by running a program of the site's own. */
#include <limits.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "plant/plant_impl.h"

enum { DEFAULT_TIMEOUT_S = 900 };

static void check(struct yaml_reader *reader, const struct yaml_map *map, const struct plant *plant, const struct plant_conversion *made)
{
    if (made->model && made->from && !strcmp(made->model, made->from))
        yaml_error(reader, yaml_map_place(map, "from"), "from: must name another file than `model`, which the conversion writes");
    for (const struct plant_conversion *other = plant->conversions; made->model && other < made; other++)
        if (other->model && !strcmp(other->model, made->model))
            yaml_error(reader, yaml_map_place(map, "model"), "model: another conversion already creates '%s' (line %d)", made->model,
                       other->line);
}

/* Puts the plant's folder in front of a relative glob(3) pattern, with a backslash before each character of the folder that would be
 * special in a pattern. */
static void resolve_pattern(const struct plant *plant, char **pattern)
{
    if (!*pattern || **pattern == '/')
        return;
    struct text whole = { 0 };
    for (const char *c = plant->files.folder; *c; c++)
        text_add(&whole, strchr("*?[{\\", *c) ? "\\%c" : "%c", *c);
    text_add(&whole, "/%s", *pattern);
    mem_free(*pattern);
    *pattern = whole.at;
}

void plant_conversions_read(struct yaml_reader *reader, yaml_node_t *node, struct plant *plant)
{
    static const struct yaml_key keys[] = { { "model", KEY_NAME, true, offsetof(struct plant_conversion, model), 0, 0, NULL, NULL },
                                            { "from", KEY_NAME, true, offsetof(struct plant_conversion, from), 0, 0, NULL, NULL },
                                            { "also", KEY_NAME, false, offsetof(struct plant_conversion, also), 0, 0, NULL, NULL },
                                            { "command", KEY_NAME, true, offsetof(struct plant_conversion, command), 0, 0, NULL, NULL },
                                            { "timeout_s", KEY_NUMBER, false, offsetof(struct plant_conversion, timeout_s), 1, 86400, NULL,
                                              NULL },
                                            { 0 } };
    int count;
    plant->conversions = plant_list_make(reader, node, "convert", 0, INT_MAX, sizeof(*plant->conversions), &count);
    for (int i = 0; i < count; i++) {
        yaml_node_t *item = yaml_list_item(reader, node, i);
        struct plant_conversion *made = &plant->conversions[plant->conversion_count++];
        struct yaml_map map;
        *made = (struct plant_conversion){ .timeout_s = DEFAULT_TIMEOUT_S, .line = yaml_place(item).line };
        yaml_map_read(reader, item, "a conversion", keys, made, &map);
        plant_resolve_path(plant, &made->model);
        plant_resolve_path(plant, &made->from);
        resolve_pattern(plant, &made->also);
        check(reader, &map, plant, made);
    }
}
