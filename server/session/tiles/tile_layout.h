/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Positions, in pixels, of the tiles of one picture that spans many displays. The picture continues behind the bezels, and has
   a margin around all tiles, so that the tiles can shift together without a gap. Pure; any thread. */
#ifndef SESSION_TILES_TILE_LAYOUT_H
#define SESSION_TILES_TILE_LAYOUT_H
#include "plant/walls/burn_shift.h"
#include "plant/walls/wall.h"
#include "render/frame.h"

struct tile_layout {
    int columns, rows;
    int display_px[2];       /* width and height in pixels of the screen of one display */
    int width_px, height_px; /* size of one tile's picture, which may have fewer pixels than its display */
    /* [0]: number of the picture's pixels that lie behind the bezels between two displays side by side; [1]: one above the
       other */
    int gap_px[2];
    /* [0]: width in pixels of the picture's margin to the left of all tiles, and also of that to their right; [1]: height of
       the margins above and below */
    int margin_px[2];
    struct burn_shift shift; /* burn-in shift of all tiles within the picture, in the display's own pixels */
};

/* Lays out the tiles of a wall, which must have tiles, for displays of that size. If the picture would have more than most_px
   pixels or too long a side, all tiles shrink by one factor. */
void tile_layout_init(struct tile_layout *layout, const struct wall *wall, int width_px, int height_px, int64_t most_px);
/* Returns the layout of the picture with the sizes of the displays' parts (tiles), the gaps between them and the margin
   multiplied by `scale`, which is at most 1. */
struct tile_layout tile_layout_scale(const struct tile_layout *layout, double scale);
/* Returns the width, or the height, in pixels of the whole picture: all tiles, the gaps between them and the margins. */
int tile_layout_width(const struct tile_layout *layout);
int tile_layout_height(const struct tile_layout *layout);
/* Returns the rectangle of one tile in the picture. display: counts from 1, row by row. */
struct frame_part tile_layout_part(const struct tile_layout *layout, int display);

#endif
