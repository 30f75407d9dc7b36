/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the tiles of one picture over many displays lie in it, in pixels. Behind bezels the picture goes on, unseen, and around all tiles,
   so that they can be moved together without a gap. Pure; any thread. */
#ifndef SESSION_TILES_TILE_LAYOUT_H
#define SESSION_TILES_TILE_LAYOUT_H
#include "plant/walls/burn_shift.h"
#include "plant/walls/wall.h"
#include "render/frame.h"

struct tile_layout {
    int columns, rows;
    int display_px[2];       /* of the display: across, down */
    int width_px, height_px; /* of a tile, which may be smaller */
    int gap_px[2];           /* between two of them: across, down */
    int margin_px[2];        /* around all of them: left and right, above and below */
    struct burn_shift shift; /* by which all tiles see the picture moved, in the display's own pixels */
};

/* Lays out the tiles of a wall that has some, for displays of that size. Where the picture would have more than most_px pixels or too long
   a side, all tiles are smaller by one factor. */
void tile_layout_init(struct tile_layout *layout, const struct wall *wall, int width_px, int height_px, int64_t most_px);
/* The same with tiles smaller by a factor of at most 1. */
struct tile_layout tile_layout_scale(const struct tile_layout *layout, double scale);
/* Width and height of the picture. */
int tile_layout_width(const struct tile_layout *layout);
int tile_layout_height(const struct tile_layout *layout);
/* Returns where a tile lies. display: from 1, row by row. */
struct frame_part tile_layout_part(const struct tile_layout *layout, int display);

#endif
