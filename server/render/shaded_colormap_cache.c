/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cache of shaded colour maps, keyed by scale and isolines; evicts the least recently used entry. */
#include "render/shaded_colormap_cache.h"

#include <string.h>

#include "base/mem.h"
#include "gpu/gl.h"

static bool same_numbers(const double *a, int a_count, const double *b, int b_count)
{
    return a_count == b_count && memcmp(a, b, (size_t)a_count * sizeof(*a)) == 0;
}

static bool same_scale(const struct scale *a, const struct scale *b)
{
    return a->map == b->map && a->min == b->min && a->max == b->max && a->log == b->log && a->interval == b->interval &&
           same_numbers(a->breaks, a->break_count, b->breaks, b->break_count);
}

static const struct colormap_shades *shades_of(struct shaded_colormap_cache *colormaps, const struct view *view, const struct colormap *map)
{
    struct colormap_shades **shades = &colormaps->shades[view_is_operator(view) ? COLORMAPS_MOST : view->colormap];
    if (!*shades) {
        *shades = mem_new(sizeof(struct colormap_shades));
        colormap_shades_init(map, *shades);
    }
    return *shades;
}

/* Returns a free entry, or the least recently used one, whose colour map it frees. */
static struct shaded_colormap_cache_entry *make_room(struct shaded_colormap_cache *colormaps)
{
    if (colormaps->count < SHADED_COLORMAPS)
        return &colormaps->at[colormaps->count++];
    struct shaded_colormap_cache_entry *oldest = &colormaps->at[0];
    for (int i = 1; i < SHADED_COLORMAPS; i++)
        if (colormaps->at[i].used < oldest->used)
            oldest = &colormaps->at[i];
    shaded_colormap_finish(&oldest->colormap);
    return oldest;
}

struct shaded_colormap shaded_colormap_cache_get(struct shaded_colormap_cache *colormaps, const struct plant *plant,
                                                 const struct view *view)
{
    struct shaded_colormap_cache_entry wanted = { .used = ++colormaps->uses };
    view_scale(plant, view, &wanted.scale);
    wanted.line_count = view_lines(view, wanted.lines);
    for (int i = 0; i < colormaps->count; i++) {
        struct shaded_colormap_cache_entry *entry = &colormaps->at[i];
        if (!same_scale(&entry->scale, &wanted.scale) || !same_numbers(entry->lines, entry->line_count, wanted.lines, wanted.line_count))
            continue;
        entry->used = colormaps->uses;
        return entry->colormap;
    }
    gl_clear_errors();
    shaded_colormap_init(&wanted.colormap, &wanted.scale, shades_of(colormaps, view, wanted.scale.map), wanted.lines, wanted.line_count);
    wanted.colormap.version = colormaps->uses;
    if (!gl_no_errors()) {
        shaded_colormap_finish(&wanted.colormap);
        return (struct shaded_colormap){ 0 };
    }
    struct shaded_colormap_cache_entry *entry = make_room(colormaps);
    *entry = wanted;
    return entry->colormap;
}

void shaded_colormap_cache_finish(struct shaded_colormap_cache *colormaps)
{
    for (int i = 0; i < colormaps->count; i++)
        shaded_colormap_finish(&colormaps->at[i].colormap);
    for (size_t i = 0; i <= COLORMAPS_MOST; i++)
        mem_free(colormaps->shades[i]);
    *colormaps = (struct shaded_colormap_cache){ 0 };
}
