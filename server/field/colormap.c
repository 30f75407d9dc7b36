/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the built-in colour maps from the embedded tables, and adds those of a plant. */
#include "field/colormap.h"

#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/embedded.h"
#include "field/lab.h"

enum { BUILT_IN = 6, MAX_MAPS = BUILT_IN + PLANT_COLORMAPS + 8 };
static struct colormap maps[MAX_MAPS] = { { .name = "relief" },  { .name = "calm" },      { .name = "viridis" },
                                          { .name = "cividis" }, { .name = "diverging" }, { .name = "turbo" } };
static size_t map_count = BUILT_IN;
static char names[MAX_MAPS - BUILT_IN][128]; /* storage for the names of added maps */
static struct colormap operator_map = { .name = "operator" };

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
    for (size_t i = 0; i < BUILT_IN; i++)
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
    return map_count;
}

const struct colormap *colormap_at(size_t index)
{
    pthread_once(&once, read_maps);
    return &maps[index];
}

/* Chooses the out-of-range colour: the candidate that is farthest from all colours of the map. */
static void choose_outside(const struct colormap *map, const uint8_t candidates[][3], int count, uint8_t out[3])
{
    double farthest = -1;
    for (int k = 0; k < count; k++) {
        double lab[3], nearest = INFINITY;
        lab_from_rgb(candidates[k], lab);
        for (int i = 0; i < 256; i += 3) {
            double at[3];
            lab_from_rgb(map->rgb[i], at);
            nearest = fmin(nearest, hypot(hypot(at[0] - lab[0], at[1] - lab[1]), at[2] - lab[2]));
        }
        if (nearest > farthest)
            memcpy(out, candidates[k], 3);
        farthest = fmax(farthest, nearest);
    }
}

int colormap_add(const char *name, const uint8_t rgb[256][3])
{
    static const uint8_t below[][3] = { { 16, 26, 94 }, { 169, 205, 255 }, { 0, 0, 0 }, { 0, 128, 128 } };
    static const uint8_t above[][3] = { { 125, 10, 30 }, { 255, 79, 216 }, { 255, 255, 255 }, { 90, 60, 0 } };
    int found = colormap_find(name);
    pthread_once(&once, read_maps);
    if (found >= 0 && found < BUILT_IN)
        return -1;
    if (found < 0 && map_count == MAX_MAPS)
        return -1;
    struct colormap *map = &maps[found < 0 ? map_count : (size_t)found];
    if (found < 0)
        snprintf(names[map_count - BUILT_IN], sizeof(names[0]), "%s", name);
    if (found < 0)
        map->name = names[map_count++ - BUILT_IN];
    memcpy(map->rgb, rgb, sizeof(map->rgb));
    choose_outside(map, below, 4, map->below);
    choose_outside(map, above, 4, map->above);
    colormap_rate_shading(map);
    return (int)(map - maps);
}

void colormaps_of_plant(const struct plant *plant)
{
    for (size_t i = 0; i < plant->display.colormap_count; i++)
        colormap_add(plant->display.colormaps[i].name, (const uint8_t(*)[3])plant->display.colormaps[i].rgb);
}

int colormap_find(const char *name)
{
    for (size_t i = 0; i < map_count; i++)
        if (strcmp(maps[i].name, name) == 0)
            return (int)i;
    return -1;
}
