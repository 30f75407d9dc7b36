/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "brush.h"

#include <math.h>
#include <pango/pangocairo.h>

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

double brush_width(cairo_t *cairo, double size_px, bool bold, const char *text)
{
    PangoLayout *layout = lay_out(cairo, size_px, bold, text);
    int width;
    pango_layout_get_pixel_size(layout, &width, NULL);
    g_object_unref(layout);
    return width;
}

void brush_text(cairo_t *cairo, const struct brush_box *box, double size_px, bool bold, enum brush_align align, const char *text)
{
    static const PangoAlignment alignments[] = { PANGO_ALIGN_LEFT, PANGO_ALIGN_CENTER, PANGO_ALIGN_RIGHT };
    PangoLayout *layout = lay_out(cairo, size_px, bold, text);
    pango_layout_set_width(layout, (int)(fmax(box->width, 1) * PANGO_SCALE));
    pango_layout_set_alignment(layout, alignments[align]);
    pango_layout_set_ellipsize(layout, PANGO_ELLIPSIZE_END);
    pango_layout_set_height(layout, -1);
    cairo_set_source_rgb(cairo, 1, 1, 1);
    cairo_move_to(cairo, box->x, box->y);
    pango_cairo_show_layout(cairo, layout);
    g_object_unref(layout);
}
