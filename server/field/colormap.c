/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Colour maps out of the embedded tables, and the legend's rule. */
#include "field/colormap.h"

#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "base/embedded.h"
#include "base/mem.h"

static struct colormap maps[] = {
    { .name = "relief" }, { .name = "viridis" }, { .name = "cividis" }, { .name = "diverging" }, { .name = "turbo" }
};
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
    mem_free(file);
    for (size_t row = 0; line && *line; line = strchr(line, '\n') + 1) {
        if (row < 256 && read_color(line, "%d,%d,%d", map->rgb[row]))
            row++;
        else if (!read_color(line, "# below %d,%d,%d", map->below))
            read_color(line, "# above %d,%d,%d", map->above);
    }
}

static void read_maps(void)
{
    for (size_t i = 0; i < MAP_COUNT; i++)
        read_map(&maps[i]);
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

/* The centre of the band that holds value. */
static float band_centre(float value, float min, float max, float interval)
{
    float bands = fmaxf(ceilf((max - min) / interval - 0.001f), 1);
    float band = fminf(floorf((value - min) / interval), bands - 1);
    float begin = min + band * interval;
    return (begin + fminf(begin + interval, max)) / 2;
}

void colormap_look_up(const struct colormap *map, double value, double min, double max, double interval, uint8_t rgb[3])
{
    float v = (float)value, low = (float)min, high = (float)max;
    const uint8_t *color = v < low ? map->below : map->above;
    if (v >= low && v <= high) {
        if (interval > 0)
            v = band_centre(v, low, high, (float)interval);
        color = map->rgb[(int)fminf((v - low) / (high - low) * 256, 255)];
    }
    memcpy(rgb, color, 3);
}
