/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Palettes by what they show; the least recently used one makes room. */
#include "render/palettes.h"

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

static const struct shaded *shaded_of(struct palettes *palettes, const struct view *view, const struct colormap *map)
{
    size_t number = view_is_operator(view) ? colormap_count() : (size_t)view->colormap;
    if (!palettes->shaded)
        palettes->shaded = mem_array(colormap_count() + 1, sizeof(struct shaded *));
    if (!palettes->shaded[number]) {
        palettes->shaded[number] = mem_new(sizeof(struct shaded));
        palette_shade_map(map, palettes->shaded[number]);
    }
    return palettes->shaded[number];
}

static void entry_finish(struct palettes_entry *entry)
{
    glDeleteTextures(1, &entry->palette.colors);
    glDeleteTextures(1, &entry->palette.lines);
}

/* A free one, or the one that was used longest ago. */
static struct palettes_entry *make_room(struct palettes *palettes)
{
    if (palettes->count < PALETTES)
        return &palettes->at[palettes->count++];
    struct palettes_entry *oldest = &palettes->at[0];
    for (int i = 1; i < PALETTES; i++)
        if (palettes->at[i].used < oldest->used)
            oldest = &palettes->at[i];
    entry_finish(oldest);
    return oldest;
}

struct palette palettes_get(struct palettes *palettes, const struct view *view)
{
    struct palettes_entry wanted = { .used = ++palettes->uses };
    view_scale(view, &wanted.scale);
    wanted.line_count = view_lines(view, wanted.lines);
    for (int i = 0; i < palettes->count; i++) {
        struct palettes_entry *entry = &palettes->at[i];
        if (!same_scale(&entry->scale, &wanted.scale) || !same_numbers(entry->lines, entry->line_count, wanted.lines, wanted.line_count))
            continue;
        entry->used = palettes->uses;
        return entry->palette;
    }
    gl_forget_errors();
    wanted.palette.colors = palette_create(&wanted.scale, shaded_of(palettes, view, wanted.scale.map));
    wanted.palette.version = palettes->uses;
    if (wanted.line_count > 0)
        wanted.palette.lines = palette_create_lines(&wanted.scale, wanted.lines, wanted.line_count);
    if (!gl_good()) {
        entry_finish(&wanted);
        return (struct palette){ 0 };
    }
    struct palettes_entry *entry = make_room(palettes);
    *entry = wanted;
    return entry->palette;
}

void palettes_finish(struct palettes *palettes)
{
    for (int i = 0; i < palettes->count; i++)
        entry_finish(&palettes->at[i]);
    for (size_t i = 0; palettes->shaded && i <= colormap_count(); i++)
        mem_free(palettes->shaded[i]);
    mem_free(palettes->shaded);
    *palettes = (struct palettes){ 0 };
}
