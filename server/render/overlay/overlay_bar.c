/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws the legend's colour bar: colours, bands, isolines, tick labels and the group's limits. */
#include <math.h>
#include <stdio.h>

#include "render/overlay/overlay_pen.h"

enum { MAX_TICKS = 40 };
struct ticks {
    double values[MAX_TICKS], places[MAX_TICKS]; /* positions of the tick labels along the bar: 0 at MIN, 1 at MAX */
    int count;
};
/* minimum distance between lines of text at the colour bar, as a multiple of the font size (text_px) */
static const double LINE_GAP = 1.12;

/* Returns a step of 1, 2 or 5 times a power of ten that divides the range into at most `count` steps. */
static double nice_step(double range, double count)
{
    double rough = range / fmax(count, 1), power = pow(10, floor(log10(rough)));
    double lead = rough / power;
    return power * (lead <= 1.0001 ? 1 : lead <= 2.0001 ? 2 : lead <= 5.0001 ? 5 : 10);
}

static void add_tick(struct ticks *ticks, const struct scale *scale, double value)
{
    double place = scale_place(scale, value);
    if (ticks->count == MAX_TICKS || place < -1e-9 || place > 1 + 1e-9)
        return;
    ticks->values[ticks->count] = value;
    ticks->places[ticks->count++] = place;
}

static void round_ticks(struct ticks *ticks, const struct scale *scale, double most)
{
    double step = nice_step(scale->max - scale->min, most);
    double first = ceil(scale->min / step - 1e-9);
    for (int i = 0; i < MAX_TICKS && (first + i) * step <= scale->max + 1e-9 * step; i++)
        add_tick(ticks, scale, (first + i) * step);
}

/* Adds ticks of a logarithmic scale: at 1, 2 and 5 times each power of ten, or only at powers of ten if there are many. */
static void log_ticks(struct ticks *ticks, const struct scale *scale, double most)
{
    static const double leads[3] = { 1, 2, 5 };
    double decades = log10(scale->max / scale->min);
    int each = decades * 3 <= most ? 3 : 1;
    for (int power = (int)floor(log10(scale->min)), last = (int)floor(log10(scale->max)); power <= last; power++)
        for (int i = 0; i < each; i++)
            add_tick(ticks, scale, pow(10, power) * leads[i]);
}

static void line_ticks(struct ticks *ticks, const struct scale *scale, const double *lines, int count)
{
    add_tick(ticks, scale, scale->min);
    for (int i = 0; i < count; i++)
        if (lines[i] != scale->min && lines[i] != scale->max)
            add_tick(ticks, scale, lines[i]);
    add_tick(ticks, scale, scale->max);
}

/* Chooses the ticks of the colour bar: both ends of the range and all isolines, if their texts fit; otherwise round numbers. */
static void choose_ticks(struct ticks *ticks, const struct pen *pen, double most)
{
    const struct view *view = &pen->view;
    struct scale scale;
    double lines[VIEW_ALL_LINES];
    view_scale(pen->scene->plant, view, &scale);
    int count = view_lines(view, lines);
    ticks->count = 0;
    if (view_is_operator(view)) {
        for (int i = 0; i < count; i++)
            add_tick(ticks, &scale, lines[i]);
    } else if (count > 0 && count + 2 <= most) {
        line_ticks(ticks, &scale, lines, count);
    } else if (scale.log) {
        log_ticks(ticks, &scale, most);
    } else {
        round_ticks(ticks, &scale, most);
    }
}

/* Moves the positions of tick labels apart until no labels overlap; all labels stay within the colour bar. */
static void spread(double *places, int count, double gap)
{
    for (int i = 1; i < count; i++)
        places[i] = fmax(places[i], places[i - 1] + gap);
    for (int i = count - 1; i >= 0; i--)
        places[i] = fmin(places[i], i == count - 1 ? 1 : places[i + 1] - gap);
}

static double most_ticks(const struct pen *pen, double height)
{
    return floor(height / (1.9 * pen->text_px)) + 1;
}

static void tick_text(const struct pen *pen, double value, char text[40])
{
    const struct view *view = &pen->view;
    if (view_is_operator(view))
        snprintf(text, 40, "%s", plant_limit_names[(int)(value > 0 ? value + 1 : value + 2)]);
    else
        pen_number(value, view->color_scale.log ? value : view->range_max - view->range_min, text);
}

static double text_width(struct pen *pen, const struct ticks *ticks)
{
    double width = 0;
    for (int i = 0; i < ticks->count; i++) {
        char text[40];
        tick_text(pen, ticks->values[i], text);
        width = fmax(width, pen_text_width(pen, text));
    }
    return width;
}

static int choose_limits(const struct pen *pen, struct ticks *ticks, int names[LIMIT_COUNT])
{
    const struct plant_group *group = &pen->scene->plant->groups[pen->view.field.group];
    struct scale scale;
    view_scale(pen->scene->plant, &pen->view, &scale);
    ticks->count = 0;
    for (int i = 0; i < LIMIT_COUNT && pen->view.field.show == SHOW_VALUE; i++) {
        int before = ticks->count;
        if (isfinite(group->limits[i]) && group->limits[i] >= scale.min)
            add_tick(ticks, &scale, group->limits[i]);
        if (ticks->count > before)
            names[before] = i;
    }
    return ticks->count;
}

double overlay_bar_left(struct pen *pen)
{
    struct ticks ticks;
    int names[LIMIT_COUNT];
    return choose_limits(pen, &ticks, names) > 0 ? 1.9 * pen->text_px : 0;
}

double overlay_bar_width(struct pen *pen)
{
    struct ticks ticks;
    choose_ticks(&ticks, pen, 12);
    pen_font(pen, 0.9, false);
    return overlay_bar_left(pen) + 2.3 * pen->text_px + text_width(pen, &ticks);
}

/* Draws the colours of the bar, one row of pixels at a time, with the colour of the value at the row's centre. */
static void draw_colors(struct pen *pen, const struct label_box *bar, const struct scale *scale)
{
    int top = (int)lround(bar->y), rows = (int)lround(bar->height);
    for (int row = 0; row < rows; row++) {
        uint8_t rgb[3];
        scale_look_up(scale, scale_value(scale, 1 - (row + 0.5) / rows), rgb);
        cairo_rectangle(pen->cairo, bar->x, top + row, bar->width, 1);
        pen_rgb(pen, rgb);
        cairo_fill(pen->cairo);
    }
}

static double height_of(const struct label_box *bar, double place)
{
    return bar->y + (1 - place) * bar->height;
}

static void draw_rule(struct pen *pen, double from_x, double from_y, double to_x, double to_y, double alpha)
{
    pen_ink(pen, alpha);
    cairo_set_line_width(pen->cairo, fmax(1, pen->unit));
    cairo_move_to(pen->cairo, from_x, from_y);
    cairo_line_to(pen->cairo, to_x, to_y);
    cairo_stroke(pen->cairo);
}

static void draw_lines(struct pen *pen, const struct label_box *bar, const struct scale *scale)
{
    double lines[VIEW_ALL_LINES];
    int count = view_lines(&pen->view, lines);
    for (int i = 0; i < count; i++) {
        double y = height_of(bar, scale_place(scale, lines[i]));
        draw_rule(pen, bar->x, y, bar->x + bar->width, y, 0.85);
    }
}

static void draw_ticks(struct pen *pen, const struct label_box *bar, const struct scale *scale)
{
    struct ticks ticks;
    double right = bar->x + bar->width;
    choose_ticks(&ticks, pen, most_ticks(pen, bar->height));
    spread(ticks.places, ticks.count, LINE_GAP * pen->text_px / bar->height);
    pen_font(pen, 0.9, false);
    for (int i = 0; i < ticks.count; i++) {
        char text[40];
        double y = height_of(bar, scale_place(scale, ticks.values[i])), text_y = height_of(bar, ticks.places[i]);
        tick_text(pen, ticks.values[i], text);
        draw_rule(pen, right, y, right + 0.4 * pen->text_px, text_y, 0.7);
        pen_ink(pen, 0.95);
        pen_text(pen, right + 0.55 * pen->text_px, text_y + 0.33 * pen->text_px, text);
    }
}

static void draw_limits(struct pen *pen, const struct label_box *bar, const struct scale *scale)
{
    static const char *const texts[LIMIT_COUNT] = { "LL", "L", "H", "HH" };
    struct ticks limits;
    int names[LIMIT_COUNT], count = choose_limits(pen, &limits, names);
    spread(limits.places, count, LINE_GAP * pen->text_px / bar->height);
    pen_font(pen, 0.8, true);
    for (int i = 0; i < count; i++) {
        double y = height_of(bar, scale_place(scale, limits.values[i])), text_y = height_of(bar, limits.places[i]);
        draw_rule(pen, bar->x, y, bar->x - 0.4 * pen->text_px, text_y, 0.9);
        pen_ink(pen, 0.9);
        pen_text(pen, bar->x - 0.5 * pen->text_px - pen_text_width(pen, texts[names[i]]), text_y + 0.3 * pen->text_px, texts[names[i]]);
    }
}

void overlay_bar(struct pen *pen, const struct label_box *bar)
{
    struct scale scale;
    view_scale(pen->scene->plant, &pen->view, &scale);
    draw_colors(pen, bar, &scale);
    draw_lines(pen, bar, &scale);
    cairo_rectangle(pen->cairo, bar->x, lround(bar->y), bar->width, lround(bar->height));
    pen_ink(pen, 0.5);
    cairo_set_line_width(pen->cairo, fmax(1, pen->unit));
    cairo_stroke(pen->cairo);
    draw_ticks(pen, bar, &scale);
    draw_limits(pen, bar, &scale);
}
