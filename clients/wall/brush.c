/* SPDX-License-Identifier: GPL-3.0-or-later */
/* By Pango, which finds a font for each script. */
#include "brush.h"

#include <math.h>
#include <pango/pangocairo.h>
#include <stdio.h>

void brush_colour(cairo_t *cairo, uint32_t rgb)
{
    cairo_set_source_rgb(cairo, (rgb >> 16 & 255) / 255.0, (rgb >> 8 & 255) / 255.0, (rgb & 255) / 255.0);
}

void brush_fill(cairo_t *cairo, const struct box *box, uint32_t rgb)
{
    cairo_rectangle(cairo, box->x, box->y, box->width, box->height);
    brush_colour(cairo, rgb);
    cairo_fill(cairo);
}

static PangoLayout *lay_out(cairo_t *cairo, double size_px, bool bold, const char *text)
{
    PangoLayout *layout = pango_cairo_create_layout(cairo);
    PangoFontDescription *font = pango_font_description_from_string("Noto Sans,DejaVu Sans,Noto Sans CJK KR,NanumGothic,sans-serif");
    pango_font_description_set_absolute_size(font, size_px * PANGO_SCALE);
    pango_font_description_set_weight(font, bold ? PANGO_WEIGHT_BOLD : PANGO_WEIGHT_NORMAL);
    pango_layout_set_font_description(layout, font);
    pango_font_description_free(font);
    pango_layout_set_text(layout, text, -1);
    return layout;
}

static struct box size_of(PangoLayout *layout)
{
    int width, height;
    pango_layout_get_pixel_size(layout, &width, &height);
    return (struct box){ 0, 0, width, height };
}

struct box brush_measure(cairo_t *cairo, double size_px, bool bold, const char *text)
{
    PangoLayout *layout = lay_out(cairo, size_px, bold, text);
    struct box size = size_of(layout);
    g_object_unref(layout);
    return size;
}

struct box brush_measure_wrapped(cairo_t *cairo, double width_px, double size_px, bool bold, const char *text)
{
    PangoLayout *layout = lay_out(cairo, size_px, bold, text);
    pango_layout_set_width(layout, (int)(fmax(width_px, 1) * PANGO_SCALE));
    pango_layout_set_wrap(layout, PANGO_WRAP_WORD_CHAR);
    struct box size = size_of(layout);
    g_object_unref(layout);
    return size;
}

struct box brush_text(cairo_t *cairo, const struct box *box, double size_px, bool bold, uint32_t rgb, enum brush_align align, bool wraps,
                      const char *text)
{
    static const PangoAlignment alignments[] = { PANGO_ALIGN_LEFT, PANGO_ALIGN_CENTER, PANGO_ALIGN_RIGHT };
    PangoLayout *layout = lay_out(cairo, size_px, bold, text);
    pango_layout_set_width(layout, (int)(fmax(box->width, 1) * PANGO_SCALE));
    pango_layout_set_alignment(layout, alignments[align]);
    pango_layout_set_ellipsize(layout, PANGO_ELLIPSIZE_END);
    pango_layout_set_height(layout, wraps ? (int)(fmax(box->height, 1) * PANGO_SCALE) : -1);
    pango_layout_set_wrap(layout, PANGO_WRAP_WORD_CHAR);
    brush_colour(cairo, rgb);
    cairo_move_to(cairo, box->x, box->y);
    pango_cairo_show_layout(cairo, layout);
    struct box size = size_of(layout);
    g_object_unref(layout);
    return size;
}

void brush_text_fitting(cairo_t *cairo, const struct box *box, double size_px, bool bold, uint32_t rgb, enum brush_align align,
                        const char *text)
{
    double part = fmax(2 / 3.0, fmin(1, box->width / fmax(1, brush_measure(cairo, size_px, bold, text).width + 2)));
    brush_text(cairo, box, size_px * part, bold, rgb, align, false, text);
}

uint32_t brush_priority(int priority)
{
    static const uint32_t colours[] = { 0xc40d20, 0xe06a0a, 0xf2bb0d, 0x1b93b5 };
    return colours[priority >= 1 && priority <= 4 ? priority - 1 : 3];
}

void brush_badge(cairo_t *cairo, double x, double y, double size_px, int priority, bool hollow)
{
    static const uint32_t inks[] = { 0xffffff, 0x1b0d00, 0x1b1300, 0x00161d };
    static const double rounds[] = { 0, 0.22, 0.5, 0.5 };
    int index = priority >= 1 && priority <= 4 ? priority - 1 : 3;
    double radius = rounds[index] * size_px, line = 0.09 * size_px;
    char text[4];
    snprintf(text, sizeof(text), "%d", index + 1);
    cairo_new_path(cairo);
    cairo_arc(cairo, x + size_px - radius, y + radius, radius, -M_PI / 2, 0);
    cairo_arc(cairo, x + size_px - radius, y + size_px - radius, radius, 0, M_PI / 2);
    cairo_arc(cairo, x + radius, y + size_px - radius, radius, M_PI / 2, M_PI);
    cairo_arc(cairo, x + radius, y + radius, radius, M_PI, 3 * M_PI / 2);
    cairo_close_path(cairo);
    brush_colour(cairo, brush_priority(priority));
    if (!hollow)
        cairo_fill_preserve(cairo);
    cairo_set_line_width(cairo, line);
    cairo_stroke(cairo);
    struct box size = brush_measure(cairo, 0.72 * size_px, true, text);
    struct box box = { x, y + 0.5 * (size_px - size.height), size_px, size.height };
    brush_text(cairo, &box, 0.72 * size_px, true, hollow ? INK : inks[index], ALIGN_CENTRE, false, text);
}
