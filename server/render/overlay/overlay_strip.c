/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws the machine-readable legend strip (protocol/strip_format.h) pixel by pixel, without smoothing the edges of its cells. */
#include <stdio.h>

#include "base/color/lab.h"
#include "protocol/strip_format.h"
#include "render/overlay/overlay_pen.h"

static const uint8_t DARK = 16, LIGHT = 255;

struct strip_ink {
    uint8_t code[STRIP_BYTES];
    uint8_t shades[STRIP_SHADES][256][3], below[STRIP_SHADES][3], above[STRIP_SHADES][3];
    struct scale scale;
};

static void choose_ink(const struct pen *pen, struct strip_ink *ink)
{
    const struct view *view = &pen->view;
    const struct plant *plant = pen->scene->plant;
    view_scale(plant, view, &ink->scale);
    struct strip strip = {
        .min = (float)ink->scale.min, .max = (float)ink->scale.max, .log = ink->scale.log, .show = (uint8_t)view->field.show
    };
    snprintf(strip.group, sizeof(strip.group), "%s", plant->groups[view->field.group].id);
    snprintf(strip.unit, sizeof(strip.unit), "%s", view_unit(plant, view));
    strip_encode(&strip, ink->code);
    double shading = view->look == LOOK_DEFAULT ? ink->scale.map->shading : 0;
    for (int s = 0; s < STRIP_SHADES; s++) {
        double light = shading * (1 - s);
        for (int i = 0; i < 256; i++)
            lab_shade(ink->scale.map->rgb[i], light, ink->shades[s][i]);
        lab_shade(ink->scale.map->below, light, ink->below[s]);
        lab_shade(ink->scale.map->above, light, ink->above[s]);
    }
}

/* Returns the colour at a column, 0 to STRIP_INNER, of the strip's inner cells. From left to right these show: below range, MIN
   to MAX, above range. */
static const uint8_t *color_at(const struct strip_ink *ink, int shade, double column)
{
    if (column < STRIP_BEYOND)
        return ink->below[shade];
    if (column >= STRIP_BEYOND + STRIP_RAMP)
        return ink->above[shade];
    int index = scale_index(&ink->scale, scale_value(&ink->scale, (column - STRIP_BEYOND) / STRIP_RAMP));
    index = index < 0 ? 0 : index > 255 ? 255 : index;
    return ink->shades[shade][index];
}

static const uint8_t *grey(bool dark)
{
    static const uint8_t greys[2][3] = { { LIGHT, LIGHT, LIGHT }, { DARK, DARK, DARK } };
    return greys[dark];
}

static const uint8_t *ink_at(const struct strip_ink *ink, double column, int row)
{
    int cell = (int)column, ramp_end = 1 + STRIP_SHADES * STRIP_SHADE_CELLS;
    if (cell < STRIP_FINDER)
        return grey(strip_finder_dark(cell));
    if (cell >= STRIP_COLUMNS - STRIP_FINDER)
        return grey(strip_finder_dark(STRIP_COLUMNS - 1 - cell));
    if (row < 1 || row >= STRIP_ROWS - 1)
        return grey(false);
    if (row < ramp_end)
        return color_at(ink, (row - 1) / STRIP_SHADE_CELLS, column - STRIP_FINDER);
    return grey(strip_cell_dark(ink->code, row - ramp_end, cell - STRIP_FINDER));
}

int overlay_strip_height(const struct frame *frame)
{
    int high = STRIP_ROWS * frame->width_px / STRIP_COLUMNS;
    /* with LOOK_MATERIALS colours show no values */
    bool wanted = frame->view.strip && frame->view.look != LOOK_MATERIALS;
    return !wanted || frame->width_px < STRIP_LEAST_PX * STRIP_COLUMNS || high > frame->height_px / 2 ? 0 : high;
}

void overlay_strip(struct pen *pen, uint8_t *bgrx, int stride_bytes)
{
    const int width = pen->frame->width_px, height = pen->frame->height_px, high = overlay_strip_height(pen->frame);
    struct strip_ink ink;
    if (high == 0)
        return;
    choose_ink(pen, &ink);
    for (int y = 0; y < high; y++) {
        uint8_t *to = bgrx + (size_t)(height - high + y) * (size_t)stride_bytes;
        for (int x = 0; x < width; x++, to += 4) {
            const uint8_t *rgb = ink_at(&ink, (x + 0.5) * STRIP_COLUMNS / width, y * STRIP_COLUMNS / width);
            to[0] = rgb[2], to[1] = rgb[1], to[2] = rgb[0];
        }
    }
}
