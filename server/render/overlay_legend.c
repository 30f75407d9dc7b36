/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The legend: what each colour, stripe and dot means. */
#include <math.h>
#include <stdio.h>

#include "render/overlay_pen.h"
#include "render/palette.h"

/* Where the legend's parts lie. */
struct layout {
    struct box card, bar;
    double pad, swatch_height;
};

static const struct plant_group *group_of(const struct pen *pen)
{
    return &pen->scene->plant->groups[pen->frame->view.field.group];
}

/* 1, 2 or 5 times a power of ten; about `count` of them in the range. */
static double nice_step(double range, double count)
{
    double rough = range / fmax(count, 1), power = pow(10, floor(log10(rough)));
    double lead = rough / power;
    return power * (lead <= 1.0001 ? 1 : lead <= 2.0001 ? 2 : lead <= 5.0001 ? 5 : 10);
}

static void format_title(const struct pen *pen, char out[160])
{
    const struct plant *plant = pen->scene->plant;
    const struct view *view = &pen->frame->view;
    const char *unit = view_unit(plant, view);
    char what[128];
    if (view->field.show == SHOW_DISTANCE)
        snprintf(what, sizeof(what), "From %s", plant->tags[view->field.sensor].name);
    else
        snprintf(what, sizeof(what), view->field.show == SHOW_DIFFERENCE ? "\u0394 %s" : "%s", group_of(pen)->quantity);
    snprintf(out, 160, *unit ? "%s [%s]" : "%s", what, unit);
}

static void lay_out(struct pen *pen, struct layout *layout)
{
    const struct frame *frame = pen->frame;
    char title[160];
    format_title(pen, title);
    pen_font(pen, 1, true);
    double width = pen_text_width(pen, title), rows = frame->view.look == LOOK_GLOSSY ? 7.6 : 6.2;
    pen_font(pen, 0.9, false);
    width = fmax(width, pen_text_width(pen, "uncertain") + 3.0 * pen->text_px);
    if (frame->view.look == LOOK_GLOSSY)
        width = fmax(width, pen_text_width(pen, "colours are shaded"));
    layout->pad = 9 * pen->unit;
    layout->swatch_height = 1.1 * pen->text_px;
    double others = rows * 1.5 * pen->text_px + 2 * layout->pad;
    double bar_height = fmax(fmin(0.46 * frame->height_px, frame->height_px - others - 4 * layout->pad), 2 * pen->text_px);
    layout->card = (struct box){ 0, 0, width + 2 * layout->pad, bar_height + others };
    layout->card.x = frame->width_px - layout->card.width - layout->pad;
    layout->card.y = 0.5 * (frame->height_px - layout->card.height);
    layout->bar =
        (struct box){ layout->card.x + layout->pad, layout->card.y + layout->pad + 3.3 * pen->text_px, 1.6 * pen->text_px, bar_height };
}

static void draw_swatch(struct pen *pen, const struct layout *layout, double y, const uint8_t rgb[3], const char *text)
{
    struct box box = { layout->bar.x, y, layout->bar.width, layout->swatch_height };
    cairo_rectangle(pen->cairo, box.x, box.y, box.width, box.height);
    pen_rgb(pen, rgb);
    cairo_fill(pen->cairo);
    pen_ink(pen, 0.9);
    pen_text(pen, box.x + box.width + 0.55 * pen->text_px, y + 0.92 * pen->text_px, text);
}

static void draw_no_data(struct pen *pen, const struct layout *layout, double y)
{
    draw_swatch(pen, layout, y, palette_no_data[0], "no data");
    cairo_save(pen->cairo);
    cairo_rectangle(pen->cairo, layout->bar.x, y, layout->bar.width, layout->swatch_height);
    cairo_clip(pen->cairo);
    pen_rgb(pen, palette_no_data[1]);
    cairo_set_line_width(pen->cairo, 0.25 * pen->text_px);
    for (double x = -layout->swatch_height; x < layout->bar.width; x += 0.5 * pen->text_px) {
        cairo_move_to(pen->cairo, layout->bar.x + x, y + layout->swatch_height);
        cairo_rel_line_to(pen->cairo, layout->swatch_height, -layout->swatch_height);
    }
    cairo_stroke(pen->cairo);
    cairo_restore(pen->cairo);
}

static void draw_uncertain(struct pen *pen, const struct layout *layout, double y)
{
    const struct colormap *map = colormap_at((size_t)pen->frame->view.colormap);
    draw_swatch(pen, layout, y, map->rgb[128], "uncertain");
    pen_rgb(pen, palette_uncertain);
    for (int i = 0; i < 6; i++) {
        double x = layout->bar.x + layout->bar.width * (i + 0.5) / 6;
        cairo_arc(pen->cairo, x, y + layout->swatch_height * (i % 2 ? 0.7 : 0.3), 0.13 * pen->text_px, 0, 2 * M_PI);
        cairo_fill(pen->cairo);
    }
}

/* The map from MIN at the bottom to MAX at the top, each row of pixels by the legend's own rule. */
static void draw_bar(struct pen *pen, const struct layout *layout)
{
    const struct view *view = &pen->frame->view;
    struct scale scale;
    view_scale(view, &scale);
    int top = (int)lround(layout->bar.y), rows = (int)lround(layout->bar.height);
    for (int row = 0; row < rows; row++) {
        uint8_t rgb[3];
        scale_look_up(&scale, scale_value(&scale, 1 - (row + 0.5) / rows), rgb);
        cairo_rectangle(pen->cairo, layout->bar.x, top + row, layout->bar.width, 1);
        pen_rgb(pen, rgb);
        cairo_fill(pen->cairo);
    }
    cairo_rectangle(pen->cairo, layout->bar.x, top, layout->bar.width, rows);
    pen_ink(pen, 0.5);
    cairo_set_line_width(pen->cairo, fmax(1, pen->unit));
    cairo_stroke(pen->cairo);
}

static void draw_ticks(struct pen *pen, const struct layout *layout)
{
    const struct view *view = &pen->frame->view;
    double range = view->range_max - view->range_min, most = layout->bar.height / (2.2 * pen->text_px);
    double step = view->ramp_interval > 0 && range / view->ramp_interval <= most ? view->ramp_interval : nice_step(range, most);
    bool from_min = step == view->ramp_interval;
    double first = from_min ? view->range_min : ceil(view->range_min / step - 1e-9) * step;
    int decimals = (int)fmin(fmax(ceil(-log10(step) - 1e-9) + (from_min && fmod(step * 10, 1) > 1e-9 ? 1 : 0), 0), 6);
    pen_font(pen, 0.9, false);
    for (double value = first; value <= view->range_max + 1e-9 * range; value += step) {
        char text[40];
        double y = layout->bar.y + (view->range_max - value) / range * layout->bar.height;
        snprintf(text, sizeof(text), "%.*f", decimals, fabs(value) < 1e-9 * range ? 0.0 : value);
        pen_ink(pen, 0.7);
        cairo_move_to(pen->cairo, layout->bar.x + layout->bar.width, y);
        cairo_rel_line_to(pen->cairo, 0.3 * pen->text_px, 0);
        cairo_stroke(pen->cairo);
        pen_ink(pen, 0.95);
        pen_text(pen, layout->bar.x + layout->bar.width + 0.55 * pen->text_px, y + 0.33 * pen->text_px, text);
    }
}

void overlay_legend(struct pen *pen)
{
    const struct view *view = &pen->frame->view;
    const struct colormap *map = colormap_at((size_t)view->colormap);
    struct layout layout;
    char text[160];
    lay_out(pen, &layout);
    pen_card(pen, &layout.card);
    pen_take(pen, &layout.card);
    format_title(pen, text);
    pen_font(pen, 1, true);
    pen_ink(pen, 1);
    pen_text(pen, layout.bar.x, layout.card.y + layout.pad + pen->text_px, text);
    pen_font(pen, 0.9, false);
    snprintf(text, sizeof(text), "> %g", view->range_max);
    draw_swatch(pen, &layout, layout.bar.y - 1.75 * pen->text_px, map->above, text);
    draw_bar(pen, &layout);
    draw_ticks(pen, &layout);
    double y = layout.bar.y + layout.bar.height + 0.65 * pen->text_px;
    snprintf(text, sizeof(text), "< %g", view->range_min);
    draw_swatch(pen, &layout, y, map->below, text);
    draw_no_data(pen, &layout, y + 2.0 * pen->text_px);
    draw_uncertain(pen, &layout, y + 3.5 * pen->text_px);
    if (view->look != LOOK_GLOSSY)
        return;
    pen_font(pen, 0.9, true);
    pen_ink(pen, 1);
    pen_text(pen, layout.bar.x, y + 6.2 * pen->text_px, "glossy:");
    pen_font(pen, 0.9, false);
    pen_text(pen, layout.bar.x, y + 7.5 * pen->text_px, "colours are shaded");
}
