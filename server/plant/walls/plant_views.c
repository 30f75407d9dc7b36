/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the plant file's `views`: views that users can open by name. */
#include <assert.h>
#include <string.h>

#include "base/mem.h"
#include "plant/plant_impl.h"
#include "plant/walls/wall.h"

static const char ID_CHARS[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-.";

static_assert(NAMED_VIEW_TITLE_BYTES == 121 && NAMED_VIEW_ADDRESS_BYTES == 2049, "the texts below name these limits");

bool named_view_id_valid(const char *id)
{
    size_t length = strlen(id);
    return length > 0 && length < NAMED_VIEW_ID_BYTES && strspn(id, ID_CHARS) == length;
}

const char *named_view_title_wrong(const char *title)
{
    return strlen(title) >= NAMED_VIEW_TITLE_BYTES ? "the title of the view is longer than 120 bytes" : NULL;
}

const char *named_view_address_wrong(const char *address)
{
    if (strlen(address) >= NAMED_VIEW_ADDRESS_BYTES)
        return "the address of the view is longer than 2048 bytes";
    if (address[0] == '#')
        return "the address of the view must not begin with #";
    for (const char *at = address; *at; at++)
        if ((unsigned char)*at <= ' ' || (unsigned char)*at >= 127)
            return "the address of the view contains a blank, a control character or a non-ASCII letter: percent-encode such characters";
    return NULL;
}

static void read_view(struct yaml_reader *reader, yaml_node_t *node, struct plant *plant, struct named_view *view)
{
    static const struct yaml_key keys[] = {
        { "id", KEY_NAME, true, offsetof(struct named_view, id), 0, 0, NULL, NULL },
        { "title", KEY_NAME, false, offsetof(struct named_view, title), 0, 0, NULL, NULL },
        { "view", KEY_NAME, true, offsetof(struct named_view, address), 0, 0, NULL, NULL },
        { 0 }
    };
    struct yaml_map map;
    view->line = yaml_place(node).line;
    if (!yaml_map_read(reader, node, "a view", keys, view, &map))
        return;
    const char *wrong = view->address ? named_view_address_wrong(view->address) : NULL;
    if (wrong)
        yaml_error(reader, yaml_map_place(&map, "view"), "view: '%.60s': %s", view->address, wrong);
    if (view->title && (wrong = named_view_title_wrong(view->title)))
        yaml_error(reader, yaml_map_place(&map, "title"), "title: '%.60s': %s", view->title, wrong);
    if (view->id && !named_view_id_valid(view->id))
        yaml_error(reader, yaml_map_place(&map, "id"), "id: expected letters, digits, '_', '-' and '.', found '%.60s'", view->id);
    plant_list_check_id(reader, &map, "view", plant->screens.views, plant->screens.view_count, sizeof(*view),
                        offsetof(struct named_view, line));
}

void plant_views_read(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct plant *plant = record;
    int count;
    plant->screens.views = plant_list_make(reader, node, "views", 0, NAMED_VIEWS, sizeof(*plant->screens.views), &count);
    for (int i = 0; i < count; i++)
        read_view(reader, yaml_list_item(reader, node, i), plant, &plant->screens.views[plant->screens.view_count++]);
}

const struct named_view *named_view_find(const struct plant *plant, const char *id)
{
    size_t i = 0;
    while (i < plant->screens.view_count && (!plant->screens.views[i].id || strcmp(plant->screens.views[i].id, id) != 0))
        i++;
    return i < plant->screens.view_count ? &plant->screens.views[i] : NULL;
}

void plant_views_free(struct plant *plant)
{
    for (size_t i = 0; i < plant->screens.view_count; i++) {
        mem_free(plant->screens.views[i].id);
        mem_free(plant->screens.views[i].title);
        mem_free(plant->screens.views[i].address);
    }
    mem_free(plant->screens.views);
}
