/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The legend: what each colour, stripe and dot means. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "render/overlay_pen.h"
#include "render/palette.h"

enum { NOTES = 4 };
/* What it says, and where its parts lie. */
struct legend {
    char title[160], above[60], below[60];
    const char *notes[NOTES]; /* below the rest; the odd words of the picture */
    int note_count;
    struct box card, bar;
    double pad, swatch_height;
};

static void add_note(struct legend *legend, const char *note)
{
    if (legend->note_count < NOTES)
        legend->notes[legend->note_count++] = note;
}

static void write_title(const struct pen *pen, struct legend *legend)
{
    const struct plant *plant = pen->scene->plant;
    const struct view *view = &pen->view;
    const char *unit = view_unit(plant, view), *quantity = plant->groups[view->field.group].quantity;
    char what[128];
    if (view->field.show == SHOW_DISTANCE)
        snprintf(what, sizeof(what), "From %s", plant->tags[view->field.sensor].name);
    else
        snprintf(what, sizeof(what), view->field.show == SHOW_DIFFERENCE ? "\u0394 %s" : "%s", quantity);
    snprintf(legend->title, sizeof(legend->title), *unit ? "%s [%s]" : "%s", what, unit);
}

static void write_words(const struct pen *pen, struct legend *legend)
{
    const struct view *view = &pen->view;
    double range = view->range_max - view->range_min;
    char number[40];
    write_title(pen, legend);
    pen_number(view->range_max, view->paint.log ? view->range_max : range, number);
    snprintf(legend->above, sizeof(legend->above), "> %s", number);
    pen_number(view->range_min, view->paint.log ? view->range_min : range, number);
    snprintf(legend->below, sizeof(legend->below), "< %s", number);
    if (view->paint.log)
        add_note(legend, "logarithmic scale");
    if (view->look == LOOK_GLOSSY)
        add_note(legend, "glossy: light changes");
    if (view->look == LOOK_GLOSSY)
        add_note(legend, "the colours");
}

static void lay_out(struct pen *pen, struct legend *legend)
{
    const struct box *area = &pen->area;
    double width, line = 1.5 * pen->text_px, top = 3.3 * pen->text_px, bottom = 4.9 * pen->text_px;
    if (legend->note_count > 0)
        bottom += (0.5 + 1.3 * legend->note_count) * pen->text_px;
    pen_font(pen, 1, true);
    width = pen_text_width(pen, legend->title);
    pen_font(pen, 0.9, false);
    width = fmax(width, overlay_bar_left(pen) + 2.2 * pen->text_px + pen_text_width(pen, "uncertain"));
    width = fmax(width, overlay_bar_left(pen) + 2.2 * pen->text_px + pen_text_width(pen, legend->above));
    width = fmax(width, overlay_bar_width(pen));
    for (int i = 0; i < legend->note_count; i++)
        width = fmax(width, pen_text_width(pen, legend->notes[i]));
    legend->pad = 9 * pen->unit;
    legend->swatch_height = 1.1 * pen->text_px;
    double others = top + bottom + 2 * legend->pad;
    double bar_height = fmax(fmin(0.46 * area->height, area->height - others - 4 * legend->pad), 2 * line);
    legend->card = (struct box){ 0, 0, width + 2 * legend->pad, bar_height + others };
    legend->card.x = area->x + area->width - legend->card.width - legend->pad;
    legend->card.y = area->y + 0.5 * (area->height - legend->card.height);
    legend->bar = (struct box){ legend->card.x + legend->pad + overlay_bar_left(pen), legend->card.y + legend->pad + top,
                                1.6 * pen->text_px, bar_height };
}

static void draw_swatch(struct pen *pen, const struct legend *legend, double y, const uint8_t rgb[3], const char *text)
{
    struct box box = { legend->bar.x, y, legend->bar.width, legend->swatch_height };
    cairo_rectangle(pen->cairo, box.x, box.y, box.width, box.height);
    pen_rgb(pen, rgb);
    cairo_fill(pen->cairo);
    pen_ink(pen, 0.95);
    pen_text(pen, box.x + box.width + 0.55 * pen->text_px, y + 0.92 * pen->text_px, text);
}

static void draw_no_data(struct pen *pen, const struct legend *legend, double y)
{
    draw_swatch(pen, legend, y, palette_no_data[0], "no data");
    cairo_save(pen->cairo);
    cairo_rectangle(pen->cairo, legend->bar.x, y, legend->bar.width, legend->swatch_height);
    cairo_clip(pen->cairo);
    pen_rgb(pen, palette_no_data[1]);
    cairo_set_line_width(pen->cairo, 0.25 * pen->text_px);
    for (double x = -legend->swatch_height; x < legend->bar.width; x += 0.5 * pen->text_px) {
        cairo_move_to(pen->cairo, legend->bar.x + x, y + legend->swatch_height);
        cairo_rel_line_to(pen->cairo, legend->swatch_height, -legend->swatch_height);
    }
    cairo_stroke(pen->cairo);
    cairo_restore(pen->cairo);
}

static void draw_uncertain(struct pen *pen, const struct legend *legend, double y)
{
    const struct colormap *map = colormap_at((size_t)pen->view.colormap);
    draw_swatch(pen, legend, y, map->rgb[128], "uncertain");
    pen_rgb(pen, palette_uncertain);
    for (int i = 0; i < 6; i++) {
        double x = legend->bar.x + legend->bar.width * (i + 0.5) / 6;
        cairo_arc(pen->cairo, x, y + legend->swatch_height * (i % 2 ? 0.7 : 0.3), 0.13 * pen->text_px, 0, 2 * M_PI);
        cairo_fill(pen->cairo);
    }
}

void overlay_legend(struct pen *pen)
{
    const struct colormap *map = colormap_at((size_t)pen->view.colormap);
    struct legend legend = { .note_count = 0 };
    write_words(pen, &legend);
    lay_out(pen, &legend);
    pen_card(pen, &legend.card);
    pen_take(pen, &legend.card);
    pen_font(pen, 1, true);
    pen_ink(pen, 1);
    pen_text(pen, legend.card.x + legend.pad, legend.card.y + legend.pad + pen->text_px, legend.title);
    pen_font(pen, 0.9, false);
    draw_swatch(pen, &legend, legend.bar.y - 1.75 * pen->text_px, map->above, legend.above);
    overlay_bar(pen, &legend.bar);
    double y = legend.bar.y + legend.bar.height + 0.65 * pen->text_px;
    pen_font(pen, 0.9, false);
    draw_swatch(pen, &legend, y, map->below, legend.below);
    draw_no_data(pen, &legend, y + 1.6 * pen->text_px);
    draw_uncertain(pen, &legend, y + 3.1 * pen->text_px);
    pen_ink(pen, 1);
    for (int i = 0; i < legend.note_count; i++)
        pen_text(pen, legend.card.x + legend.pad, y + (5.6 + 1.3 * i) * pen->text_px, legend.notes[i]);
}
