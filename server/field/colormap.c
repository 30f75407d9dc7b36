/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Colour maps out of the embedded tables. */
#include "field/colormap.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "base/embedded.h"
#include "base/mem.h"

static struct colormap maps[] = {
    { .name = "relief" }, { .name = "calm" }, { .name = "viridis" }, { .name = "cividis" }, { .name = "diverging" }, { .name = "turbo" }
};
static struct colormap operator_map = { .name = "operator" };
#define MAP_COUNT (sizeof(maps) / sizeof(*maps))

static pthread_once_t once = PTHREAD_ONCE_INIT;

static bool read_color(const char *line, const char *format, uint8_t rgb[3])
{
    int r, g, b;
    if (sscanf(line, format, &r, &g, &b) != 3)
        return false;
    rgb[0] = (uint8_t)r;
    rgb[1] = (uint8_t)g;
    rgb[2] = (uint8_t)b;
    return true;
}

static void read_map(struct colormap *map)
{
    char *file = mem_printf("maps/%s.csv", map->name);
    const char *line = embedded_find(file);
    char word[8] = "";
    mem_free(file);
    for (size_t row = 0; line && *line; line = strchr(line, '\n') + 1) {
        if (row < 256 && read_color(line, "%d,%d,%d", map->rgb[row]))
            row++;
        else if (sscanf(line, "# shading %lf, %7s", &map->shading, word) >= 1)
            map->safe = !strcmp(word, "safe");
        else if (!read_color(line, "# below %d,%d,%d", map->below))
            read_color(line, "# above %d,%d,%d", map->above);
    }
}

static void read_maps(void)
{
    for (size_t i = 0; i < MAP_COUNT; i++)
        read_map(&maps[i]);
    read_map(&operator_map);
}

const struct colormap *colormap_operator(void)
{
    pthread_once(&once, read_maps);
    return &operator_map;
}

size_t colormap_count(void)
{
    return MAP_COUNT;
}

const struct colormap *colormap_at(size_t index)
{
    pthread_once(&once, read_maps);
    return &maps[index];
}

int colormap_find(const char *name)
{
    for (size_t i = 0; i < MAP_COUNT; i++)
        if (strcmp(maps[i].name, name) == 0)
            return (int)i;
    return -1;
}
