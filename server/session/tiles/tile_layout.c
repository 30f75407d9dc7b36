/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "session/tiles/tile_layout.h"

#include <math.h>

static const double MM_PER_INCH = 25.4;
enum { LEAST_PX = 16 };

int tile_layout_width(const struct tile_layout *layout)
{
    return layout->columns * layout->width_px + (layout->columns - 1) * layout->gap_px[0] + 2 * layout->margin_px[0];
}

int tile_layout_height(const struct tile_layout *layout)
{
    return layout->rows * layout->height_px + (layout->rows - 1) * layout->gap_px[1] + 2 * layout->margin_px[1];
}

/* Scales the width or height of a tile (one display's part of the picture) and rounds it to an even number of pixels. With an
   odd number, encoders with chroma subsampling would blend the last column or row with the next tile's pixels. */
static int scaled(int px, double scale)
{
    int less = (int)(px * scale) & ~1;
    return scale >= 1 ? px : less > LEAST_PX ? less : LEAST_PX;
}

struct tile_layout tile_layout_scale(const struct tile_layout *layout, double scale)
{
    struct tile_layout out = *layout;
    out.width_px = scaled(layout->width_px, scale);
    out.height_px = scaled(layout->height_px, scale);
    /* Scales the gaps between tiles, and the margin. The factor is `scale` or, if rounding to whole pixels made the tile shrink
       more than that, the factor by which the tile shrank. */
    double across = fmin(scale, (double)out.width_px / layout->width_px), down = fmin(scale, (double)out.height_px / layout->height_px);
    out.gap_px[0] = (int)lround(layout->gap_px[0] * across);
    out.gap_px[1] = (int)lround(layout->gap_px[1] * down);
    out.margin_px[0] = (int)lround(layout->margin_px[0] * across);
    out.margin_px[1] = (int)lround(layout->margin_px[1] * down);
    return out;
}

void tile_layout_init(struct tile_layout *layout, const struct wall *wall, int width_px, int height_px, int64_t most_px)
{
    const struct wall_tile *tile = &wall->tile;
    double px_per_mm = hypot(width_px, height_px) / (wall->inches * MM_PER_INCH);
    struct tile_layout full = { .columns = tile->columns,
                                .rows = tile->rows,
                                .display_px = { width_px, height_px },
                                .width_px = width_px,
                                .height_px = height_px,
                                .margin_px = { BURN_SHIFT_PX, BURN_SHIFT_PX } };
    for (int i = 0; i < 2; i++)
        full.gap_px[i] = (int)lround(tile->bezel_mm[i] * px_per_mm);
    double width = tile_layout_width(&full), height = tile_layout_height(&full), side = fmax(width, height);
    double scale = fmin(1, fmin(VIEW_MAX_SIDE_PX / side, sqrt((double)most_px / (width * height))));
    *layout = tile_layout_scale(&full, scale);
    while (scale > 0.01 && (tile_layout_width(layout) > VIEW_MAX_SIDE_PX || tile_layout_height(layout) > VIEW_MAX_SIDE_PX ||
                            /* shrinks again if needed, because rounding to whole pixels may make the picture exceed the limit */
                            (int64_t)tile_layout_width(layout) * tile_layout_height(layout) > most_px))
        *layout = tile_layout_scale(&full, scale *= 0.99);
}

/* Converts the burn-in shift from display pixels to picture pixels: BURN_SHIFT_PX display pixels are margin_px picture pixels. */
static int shift_within(int shift_px, int margin_px)
{
    return (int)lround((double)shift_px * margin_px / BURN_SHIFT_PX);
}

struct frame_part tile_layout_part(const struct tile_layout *layout, int display)
{
    int column = (display - 1) % layout->columns, row = (display - 1) / layout->columns;
    int left_px = layout->margin_px[0] - shift_within(layout->shift.x_px, layout->margin_px[0]);
    int top_px = layout->margin_px[1] - shift_within(layout->shift.y_px, layout->margin_px[1]);
    return (struct frame_part){ .x_px = left_px + column * (layout->width_px + layout->gap_px[0]),
                                .y_px = top_px + row * (layout->height_px + layout->gap_px[1]),
                                .width_px = layout->width_px,
                                .height_px = layout->height_px };
}
