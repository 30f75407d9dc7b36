/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Drawing functions that all overlay files use: text, colours, cards (backgrounds of text), and the list of occupied areas. */
#include "render/overlay/overlay_pen.h"

#include <math.h>
#include <stdio.h>

#include "render/overlay/text_face.h"

bool box_meets(const struct label_box *a, const struct label_box *b)
{
    return a->x < b->x + b->width && b->x < a->x + a->width && a->y < b->y + b->height && b->y < a->y + a->height;
}

bool pen_is_free(const struct pen *pen, const struct label_box *box)
{
    const struct label_box *area = &pen->area;
    double right = area->x + area->width, bottom = area->y + area->height;
    if (box->x < area->x || box->y < area->y || box->x + box->width > right || box->y + box->height > bottom)
        return false;
    for (int i = 0; i < pen->taken_count; i++)
        if (box_meets(&pen->taken[i], box))
            return false;
    return true;
}

void pen_take(struct pen *pen, const struct label_box *box)
{
    if (pen->taken_count < PEN_MAX_TAKEN)
        pen->taken[pen->taken_count++] = *box;
}

void pen_rounded_path(struct pen *pen, const struct label_box *box)
{
    cairo_t *cairo = pen->cairo;
    double x = box->x, y = box->y, right = x + box->width, bottom = y + box->height, radius = 4 * pen->unit;
    cairo_new_path(cairo);
    cairo_arc(cairo, right - radius, y + radius, radius, -M_PI / 2, 0);
    cairo_arc(cairo, right - radius, bottom - radius, radius, 0, M_PI / 2);
    cairo_arc(cairo, x + radius, bottom - radius, radius, M_PI / 2, M_PI);
    cairo_arc(cairo, x + radius, y + radius, radius, M_PI, 3 * M_PI / 2);
    cairo_close_path(cairo);
}

void pen_card(struct pen *pen, const struct label_box *box)
{
    pen_rounded_path(pen, box);
    bool dark = pen->frame->view.dark;
    if (dark)
        cairo_set_source_rgba(pen->cairo, 0.17, 0.19, 0.22, 0.92);
    else
        cairo_set_source_rgba(pen->cairo, 1, 1, 1, 0.88);
    cairo_fill_preserve(pen->cairo);
    if (dark)
        cairo_set_source_rgba(pen->cairo, 1, 1, 1, 0.2);
    else
        cairo_set_source_rgba(pen->cairo, 0.35, 0.40, 0.46, 0.35);
    cairo_set_line_width(pen->cairo, fmax(1, pen->unit));
    cairo_stroke(pen->cairo);
}

void pen_rgb(struct pen *pen, const uint8_t rgb[3])
{
    cairo_set_source_rgb(pen->cairo, rgb[0] / 255.0, rgb[1] / 255.0, rgb[2] / 255.0);
}

void pen_ink(struct pen *pen, double alpha)
{
    if (pen->frame->view.dark)
        cairo_set_source_rgba(pen->cairo, 0.91, 0.92, 0.93, alpha);
    else
        pen_dark(pen, alpha);
}

void pen_dark(struct pen *pen, double alpha)
{
    cairo_set_source_rgba(pen->cairo, 0.10, 0.13, 0.17, alpha);
}

void pen_font(struct pen *pen, double size, bool bold)
{
    cairo_select_font_face(pen->cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(pen->cairo, size * pen->text_px);
}

double pen_text_width(struct pen *pen, const char *text)
{
    cairo_text_extents_t extents;
    cairo_save(pen->cairo);
    text_face_choose(pen->cairo, text);
    cairo_text_extents(pen->cairo, text, &extents);
    cairo_restore(pen->cairo);
    return extents.x_advance;
}

void pen_text(struct pen *pen, double x, double y, const char *text)
{
    cairo_save(pen->cairo);
    text_face_choose(pen->cairo, text);
    cairo_move_to(pen->cairo, x, y);
    cairo_show_text(pen->cairo, text);
    cairo_restore(pen->cairo);
}

void pen_number(double value, double range, char out[40])
{
    int decimals = 0;
    for (double unit = 1; decimals < 9 && fabs(value - round(value * unit) / unit) > range / 5000; unit *= 10)
        decimals++;
    snprintf(out, 40, "%.*f", decimals, fabs(value) < range / 5000 ? 0.0 : value);
}

double pen_rounded(double value, int decimals)
{
    return fabs(value) < 0.5 * pow(10, -decimals) ? 0 : value;
}

int pen_decimals(const struct plant_group *group, double value)
{
    double range = group->max - group->min;
    if (group->log)
        range = value != 0 ? fabs(value) : group->min;
    return (int)fmin(fmax(ceil(-log10(range / 500)), 0), 6);
}

const char *pen_word(const struct pen *pen, enum overlay_word word)
{
    return overlay_word(pen->frame->view.language, word);
}

void pen_say(const struct pen *pen, enum overlay_word word, const char *a, const char *b, char *out, size_t size)
{
    overlay_say(pen->frame->view.language, word, a, b, out, size);
}

void pen_choose_half(struct pen *pen, int half)
{
    const struct view *view = &pen->frame->view;
    int left_px = half ? view_left_px(view) : 0;
    pen->half = half;
    view_half(view, half, &pen->view);
    pen->area = (struct label_box){ left_px, 0, pen->view.width_px, pen->view.height_px - overlay_strip_height(pen->frame) };
}
