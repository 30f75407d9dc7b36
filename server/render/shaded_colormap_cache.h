/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cache of recently used shaded colour maps. Call only in the thread that owns the GL context. */
#ifndef RENDER_SHADED_COLORMAP_CACHE_H
#define RENDER_SHADED_COLORMAP_CACHE_H
#include "render/shaded_colormap.h"

struct shaded_colormap_cache_entry {
    struct scale scale;
    double lines[VIEW_ALL_LINES];
    int line_count;
    struct shaded_colormap colormap;
    uint64_t used;
};

enum { SHADED_COLORMAPS = 16, COLORMAPS_MOST = COLORMAPS_BUILT_IN + PLANT_COLORMAPS };
struct shaded_colormap_cache { /* zero-initialise */
    /* by colour map: its colours at all brightness steps; the last element is for views of values relative to alarm limits;
       NULL: not used yet */
    struct colormap_shades *shades[COLORMAPS_MOST + 1];
    struct shaded_colormap_cache_entry at[SHADED_COLORMAPS];
    int count;
    uint64_t uses;
};

/* Returns the colour map of the view, valid until SHADED_COLORMAPS others have been requested. All zero: out of GPU memory. */
struct shaded_colormap shaded_colormap_cache_get(struct shaded_colormap_cache *colormaps, const struct plant *plant,
                                                 const struct view *view);
void shaded_colormap_cache_finish(struct shaded_colormap_cache *colormaps);

#endif
