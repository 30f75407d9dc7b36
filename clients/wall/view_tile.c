/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "view_tile.h"

#include <stdio.h>
#include <string.h>

#include "base/mem.h"

static const int64_t EARLY_US = 4000; /* the next picture of the screen comes within 17 ms */

static void drop(struct view_tile *tile, int first, int count)
{
    for (int i = first; i < first + count; i++)
        mem_free(tile->kept[i].pixels);
    tile->kept_count -= count;
    memmove(tile->kept + first, tile->kept + first + count, (size_t)(tile->kept_count - first) * sizeof(tile->kept[0]));
}

static void add_order(struct view_tile *tile, struct tile_order order)
{
    if (tile->order_count == TILE_ORDERS)
        tile->order_count--;
    tile->orders[tile->order_count++] = order;
}

void view_tile_clear(struct view_tile *tile)
{
    drop(tile, 0, tile->kept_count);
    tile->order_count = 0;
    tile->leads = false;
    tile->late_us = 0;
    tile->missing[0] = 0;
}

static void add_missing(struct view_tile *tile, const json_t *display)
{
    size_t length = strlen(tile->missing);
    snprintf(tile->missing + length, sizeof(tile->missing) - length, "%s%d", length ? ", " : "", (int)json_integer_value(display));
}

void view_tile_hear(struct view_tile *tile, const char *type, const json_t *message)
{
    if (!strcmp(type, "present")) {
        add_order(tile, (struct tile_order){ (uint32_t)json_integer_value(json_object_get(message, "seq")),
                                             json_integer_value(json_object_get(message, "at_us")) });
    } else if (!strcmp(type, "tiles")) {
        const json_t *missing = json_object_get(message, "missing"), *late = json_object_get(message, "late");
        for (size_t i = 0; i < 4; i++)
            tile->part[i] = json_number_value(json_array_get(json_object_get(message, "part"), i));
        tile->leads = json_is_true(json_object_get(message, "leads"));
        tile->late_us = 0;
        tile->missing[0] = 0;
        for (size_t i = 0; i < json_array_size(missing); i++)
            add_missing(tile, json_array_get(missing, i));
        for (size_t i = 0; i < json_array_size(late); i++) {
            const json_t *one = json_array_get(late, i), *display = json_object_get(one, "display");
            if (json_integer_value(display) == tile->display)
                tile->late_us = json_integer_value(json_object_get(one, "since_us"));
            else
                add_missing(tile, display);
        }
    }
}

void view_tile_keep(struct view_tile *tile, const struct wire_frame *frame, const uint8_t *pixels)
{
    size_t bytes = (size_t)frame->full_width_px * frame->full_height_px * 4;
    uint8_t *copy = mem_try_array(bytes, 1);
    if (!copy)
        return;
    if (tile->kept_count == TILE_KEPT)
        drop(tile, TILE_KEPT - 1, 1);
    memcpy(copy, pixels, bytes);
    tile->kept[tile->kept_count++] = (struct tile_picture){ *frame, copy };
}

bool view_tile_take(struct view_tile *tile, int64_t now_us, struct tile_picture *out)
{
    int due = 0, count = 0;
    while (due < tile->order_count && now_us + EARLY_US >= tile->orders[due].at_us)
        due++;
    if (due == 0)
        return false;
    uint32_t seq = tile->orders[due - 1].seq;
    tile->order_count -= due;
    memmove(tile->orders, tile->orders + due, (size_t)tile->order_count * sizeof(tile->orders[0]));
    while (count < tile->kept_count && tile->kept[count].frame.seq <= seq)
        count++;
    if (count == 0)
        return false;
    *out = tile->kept[count - 1];
    tile->kept[count - 1].pixels = NULL;
    drop(tile, 0, count);
    return true;
}
