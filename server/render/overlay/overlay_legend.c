/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws the legend: the meaning of each colour, pattern and ring. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "plant/influence.h"
#include "render/overlay/overlay_pen.h"
#include "plant/colormaps.h"
#include "render/shaded_colormap.h"

enum { NOTES = 6, ROWS = 7 + ALARM_PRIORITIES };
static const double ROW = 1.5, NOTE = 1.3; /* heights in text_px */
enum row {
    ROW_BELOW,
    ROW_NO_LIMITS,
    ROW_NO_DATA,
    ROW_UNCERTAIN,
    ROW_UNPROVEN,
    ROW_ASSUMED,
    ROW_ARROW,
    ROW_NOWHERE,
    ROW_ALARM /* priority 1; further priorities follow */
};
/* Texts of the legend, and positions of its card (background) and colour bar. */
struct legend {
    char title[160], above[60], below[60], since[120], longest[80], drawn_error[120];
    enum row rows[ROWS]; /* rows below the colour bar */
    const char *notes[NOTES];
    int row_count, note_count;
    struct label_box card, bar;
    double pad;
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
    static const char *const forms[] = { "%s", "", "\u0394 %s", "%s", "\u00b1 %s", "" }; /* indexed by enum field_show */
    const char *name = view->field.show == SHOW_DISTANCE ? plant->tags[view->field.sensor].name : quantity;
    char what[128];
    if (view->field.show == SHOW_DISTANCE || view->field.show == SHOW_BLIND)
        pen_say(pen, view->field.show == SHOW_DISTANCE ? WORD_FROM : WORD_HOT_SPOT, name, NULL, what, sizeof(what));
    else
        snprintf(what, sizeof(what), forms[view->field.show], name);
    snprintf(legend->title, sizeof(legend->title), *unit ? "%s [%s]" : "%s", what, unit);
}

/* Returns the priorities of all active alarms as bits (1 << priority). Alarms of hidden sensors count, because they are listed.
   Without a snapshot, readings are not known yet: returns one bit, to make the legend wide enough for a row of alarms. */
static unsigned priorities_shown(const struct pen *pen)
{
    const struct plant *plant = pen->scene->plant;
    unsigned priorities = pen->snapshot ? 0 : 1u << ALARM_PRIORITIES;
    for (size_t i = 0; pen->snapshot && !pen->bare && i < plant->tag_count && i < pen->snapshot->count; i++) {
        enum alarm_kind alarm = (enum alarm_kind)pen->snapshot->readings[i].alarm;
        if (alarm)
            priorities |= 1u << alarm_priority(&plant->tags[i], alarm);
    }
    return priorities;
}

static bool shows_unproven(const struct pen *pen)
{
    for (size_t i = 0; i < pen->frame->marker_count && !pen->bare; i++)
        if (pen->frame->markers[i].half == pen->half && overlay_unproven(pen, pen->frame->markers[i].tag))
            return true;
    return false;
}

/* Returns whether the group has a tag with an assumed position, which the legend then explains. The tag's marker need not be visible, since
   its reading also colours its equipment. */
static bool shows_assumed(const struct pen *pen)
{
    const struct plant *plant = pen->scene->plant;
    for (size_t i = 0; i < plant->tag_count; i++)
        if (plant->tags[i].place.assumed && plant->tags[i].asset >= 0 && plant->tags[i].group == pen->view.field.group)
            return true;
    return false;
}

/* Returns whether either half of the frame has a cross for an unknown direction. If both halves share a legend, it must explain the crosses
   of both. */
static bool shows_unknown_direction(const struct pen *pen)
{
    for (size_t i = 0; i < pen->frame->label_count; i++)
        if (overlay_is_unknown_direction(&pen->frame->labels[i]))
            return true;
    return false;
}

/* Chooses the rows of the legend below the colour bar. Distances, and quantities that are computed without readings, have a row
   "uncertain" only if they are interpolated from distances along surfaces. They have a row "below range" only if the view's range
   begins above their minimum. */
static void choose_rows(const struct pen *pen, struct legend *legend)
{
    const struct view *view = &pen->view;
    const struct plant_group *group = &pen->scene->plant->groups[view->field.group];
    bool of_readings = view->field.show != SHOW_DISTANCE && !field_params_cover(&view->field);
    double least = view->field.show == SHOW_BLIND ? PLANT_SEEN_PART * (group->max - group->min) : 0;
    legend->row_count = 0;
    if (view_is_operator(view))
        legend->rows[legend->row_count++] = ROW_NO_LIMITS;
    else if (of_readings || view->range_min > 1.001 * least)
        legend->rows[legend->row_count++] = ROW_BELOW;
    legend->rows[legend->row_count++] = ROW_NO_DATA;
    if (of_readings || (view->field.show != SHOW_UNCERTAINTY && view->field.distance != DISTANCE_EUCLIDEAN))
        legend->rows[legend->row_count++] = ROW_UNCERTAIN;
    if (shows_unproven(pen))
        legend->rows[legend->row_count++] = ROW_UNPROVEN;
    if (shows_assumed(pen))
        legend->rows[legend->row_count++] = ROW_ASSUMED;
    /* a row that explains the length is needed only for arrows; the length of strokes (short streamlines) has no meaning */
    if (overlay_has_arrows(pen)) {
        if (view->directions == DIRECTIONS_ARROWS)
            legend->rows[legend->row_count++] = ROW_ARROW;
        if (shows_unknown_direction(pen))
            legend->rows[legend->row_count++] = ROW_NOWHERE;
    }
    unsigned priorities = priorities_shown(pen);
    for (int i = 1; i <= ALARM_PRIORITIES; i++)
        if (priorities & 1u << i)
            legend->rows[legend->row_count++] = (enum row)(ROW_ALARM + i - 1);
}

/* Writes the baseline that the half subtracts: its name, or its time in the plant's time zone. */
static void write_baseline(const struct pen *pen, struct legend *legend)
{
    const struct baseline *baseline = &pen->frame->baseline[pen->half];
    time_t seconds = (time_t)(baseline->taken_utc_ns / NS_PER_S);
    struct tm local;
    char what[81] = "";
    if (baseline->name[0])
        snprintf(what, sizeof(what), "%.80s", baseline->name);
    else if (localtime_r(&seconds, &local))
        strftime(what, sizeof(what), "%m-%d %H:%M:%S", &local);
    pen_say(pen, WORD_SINCE, what, NULL, legend->since, sizeof(legend->since));
    if (baseline->id)
        add_note(legend, legend->since);
}

static void write_hot_spot(const struct pen *pen, struct legend *legend)
{
    const struct plant_group *group = &pen->scene->plant->groups[pen->view.field.group];
    char metres[40], percent[40];
    snprintf(metres, sizeof(metres), "%g", group->hot_spot_m);
    snprintf(percent, sizeof(percent), "%g", 100 * PLANT_SEEN_PART);
    pen_say(pen, WORD_HOT_SPOT_SIZE, metres, percent, legend->since, sizeof(legend->since));
    add_note(legend, legend->since);
}

/* Writes the error bound for areas that the frame marks with dots: how far values interpolated over a triangle may deviate from
   the exact field. */
static void write_drawn_error(const struct pen *pen, struct legend *legend)
{
    const char *unit = view_is_operator(&pen->view) ? "" : view_unit(pen->scene->plant, &pen->view);
    char number[80];
    if (!(pen->frame->drawn_error[pen->half] > 0))
        return;
    snprintf(number, sizeof(number), "%g %.60s", pen->frame->drawn_error[pen->half], unit);
    pen_say(pen, WORD_DRAWN_ERROR_2, number, NULL, legend->drawn_error, sizeof(legend->drawn_error));
    add_note(legend, pen_word(pen, WORD_DRAWN_ERROR));
    add_note(legend, legend->drawn_error);
}

static void write_words(const struct pen *pen, struct legend *legend)
{
    const struct view *view = &pen->view;
    double range = view->range_max - view->range_min;
    char number[40];
    write_title(pen, legend);
    choose_rows(pen, legend);
    if (view_is_operator(view)) {
        add_note(legend, pen_word(pen, WORD_BY_LIMITS));
    } else {
        pen_number(view->range_max, view->color_scale.log ? view->range_max : range, number);
        snprintf(legend->above, sizeof(legend->above), "> %s", number);
        pen_number(view->range_min, view->color_scale.log ? view->range_min : range, number);
        snprintf(legend->below, sizeof(legend->below), "< %s", number);
        if (view->color_scale.log)
            add_note(legend, pen_word(pen, WORD_LOGARITHMIC));
    }
    if (overlay_has_arrows(pen) && view->directions == DIRECTIONS_ARROWS) {
        pen_number(overlay_arrow_value(pen), overlay_arrow_value(pen), number);
        snprintf(legend->longest, sizeof(legend->longest), "%s %.30s", number, view_unit(pen->scene->plant, view));
    }
    if (view->field.show == SHOW_DIFFERENCE)
        write_baseline(pen, legend);
    if (view->field.show == SHOW_UNCERTAINTY)
        add_note(legend, pen_word(pen, WORD_DEVIATION));
    if (view->field.show == SHOW_BLIND)
        write_hot_spot(pen, legend);
    if (!view_is_operator(view) && !colormap_at(pen->scene->plant, (size_t)view->colormap)->safe)
        add_note(legend, pen_word(pen, WORD_MISREAD));
    write_drawn_error(pen, legend);
    if (view->look == LOOK_GLOSSY) {
        add_note(legend, pen_word(pen, WORD_GLOSSY));
        add_note(legend, pen_word(pen, WORD_GLOSSY_2));
    }
}

static const char *row_text(const struct pen *pen, const struct legend *legend, enum row row)
{
    static const enum overlay_word texts[] = {
        [ROW_NO_LIMITS] = WORD_NO_LIMITS, [ROW_NO_DATA] = WORD_NO_DATA,       [ROW_UNCERTAIN] = WORD_UNCERTAIN,
        [ROW_UNPROVEN] = WORD_UNPROVEN,   [ROW_ASSUMED] = WORD_PLACE_ASSUMED, [ROW_NOWHERE] = WORD_DIRECTION_UNKNOWN,
        [ROW_ALARM] = WORD_PRIORITY_1,    [ROW_ALARM + 1] = WORD_PRIORITY_2,  [ROW_ALARM + 2] = WORD_PRIORITY_3,
        [ROW_ALARM + 3] = WORD_PRIORITY_4
    };
    return row == ROW_BELOW ? legend->below : row == ROW_ARROW ? legend->longest : pen_word(pen, texts[row]);
}

/* Returns the lowest y at which the legend's card does not overlap anything already drawn. */
static double free_from(const struct pen *pen, const struct label_box *card)
{
    double from = pen->area.y;
    for (int i = 0; i < pen->taken_count; i++)
        if (card->x < pen->taken[i].x + pen->taken[i].width && pen->taken[i].x < card->x + card->width && pen->taken[i].y < card->y)
            from = fmax(from, pen->taken[i].y + pen->taken[i].height);
    return from;
}

static void lay_out(struct pen *pen, struct legend *legend)
{
    const struct label_box *area = &pen->area;
    double left = overlay_bar_left(pen), beside = left + 2.2 * pen->text_px, width;
    double top = (legend->above[0] ? 3.3 : 1.7) * pen->text_px, bottom = (0.4 + ROW * legend->row_count) * pen->text_px;
    if (legend->note_count > 0)
        bottom += (0.4 + NOTE * legend->note_count) * pen->text_px;
    pen_font(pen, 1, true);
    width = pen_text_width(pen, legend->title);
    pen_font(pen, 0.9, false);
    width = fmax(width, beside + pen_text_width(pen, legend->above));
    for (int i = 0; i < legend->row_count; i++)
        width = fmax(width, beside + pen_text_width(pen, row_text(pen, legend, legend->rows[i])));
    for (int i = 0; i < legend->note_count; i++)
        width = fmax(width, pen_text_width(pen, legend->notes[i]));
    /* the legend is always wide enough for the row "unknown direction", because its width is needed before it is known whether
       the frame shows that row */
    if (overlay_has_arrows(pen))
        width = fmax(width, beside + pen_text_width(pen, row_text(pen, legend, ROW_NOWHERE)));
    width = fmax(width, overlay_bar_width(pen));
    if (legend->longest[0])
        width = fmax(width, overlay_arrow_px(pen) + 0.55 * pen->text_px + pen_text_width(pen, legend->longest));
    legend->pad = 9 * pen->unit;
    double others = top + bottom + 2 * legend->pad;
    double bar_height = fmax(fmin(0.46 * area->height, area->height - others - 4 * legend->pad), 3 * pen->text_px);
    legend->card = (struct label_box){ 0, 0, width + 2 * legend->pad, bar_height + others };
    legend->card.x = area->x + area->width - legend->card.width - legend->pad;
    legend->card.y = area->y + 0.5 * (area->height - legend->card.height);
    double from = free_from(pen, &legend->card) + legend->pad, room = area->y + area->height - legend->pad - from;
    if (legend->card.y < from) {
        bar_height = fmax(bar_height - fmax(legend->card.height - room, 0), 3 * pen->text_px);
        legend->card.height = bar_height + others;
        legend->card.y = from;
    }
    legend->bar =
        (struct label_box){ legend->card.x + legend->pad + left, legend->card.y + legend->pad + top, 1.6 * pen->text_px, bar_height };
}

/* --- swatches ---------------------------------------------------------------------------------------------------------------- */

static void fill_box(struct pen *pen, const struct label_box *box, const uint8_t rgb[3])
{
    cairo_rectangle(pen->cairo, box->x, box->y, box->width, box->height);
    pen_rgb(pen, rgb);
    cairo_fill_preserve(pen->cairo);
    /* before a dark backdrop the colour sample gets an outline, because some colours are as dark as the legend's background */
    if (pen->frame->view.dark) {
        pen_ink(pen, 0.5);
        cairo_set_line_width(pen->cairo, fmax(1, pen->unit));
        cairo_stroke(pen->cairo);
    }
    cairo_new_path(pen->cairo);
}

static void draw_stripes(struct pen *pen, const struct label_box *box)
{
    fill_box(pen, box, colormap_no_data[0]);
    cairo_save(pen->cairo);
    cairo_rectangle(pen->cairo, box->x, box->y, box->width, box->height);
    cairo_clip(pen->cairo);
    pen_rgb(pen, colormap_no_data[1]);
    cairo_set_line_width(pen->cairo, 0.25 * pen->text_px);
    for (double x = -box->height; x < box->width; x += 0.5 * pen->text_px) {
        cairo_move_to(pen->cairo, box->x + x, box->y + box->height);
        cairo_rel_line_to(pen->cairo, box->height, -box->height);
    }
    cairo_stroke(pen->cairo);
    cairo_restore(pen->cairo);
}

static void draw_rules(struct pen *pen, const struct label_box *box)
{
    fill_box(pen, box, colormap_no_limits[0]);
    for (int i = 0; i < 3; i++)
        fill_box(pen, &(struct label_box){ box->x, box->y + box->height * (0.12 + 0.33 * i), box->width, 0.1 * box->height },
                 colormap_no_limits[1]);
}

static void draw_dots(struct pen *pen, const struct label_box *box)
{
    struct scale scale;
    view_scale(pen->scene->plant, &pen->view, &scale);
    fill_box(pen, box, scale.map->rgb[128]);
    pen_rgb(pen, colormap_uncertain);
    for (int i = 0; i < 6; i++) {
        cairo_arc(pen->cairo, box->x + box->width * (i + 0.5) / 6, box->y + box->height * (i % 2 ? 0.7 : 0.3), 0.13 * pen->text_px, 0,
                  2 * M_PI);
        cairo_fill(pen->cairo);
    }
}

static void draw_swatch(struct pen *pen, const struct label_box *box, enum row row)
{
    struct scale scale;
    view_scale(pen->scene->plant, &pen->view, &scale);
    switch (row) {
    case ROW_BELOW: fill_box(pen, box, scale.map->below); break;
    case ROW_NO_LIMITS: draw_rules(pen, box); break;
    case ROW_NO_DATA: draw_stripes(pen, box); break;
    case ROW_UNCERTAIN: draw_dots(pen, box); break;
    case ROW_UNPROVEN:
        pen_ink(pen, 1);
        overlay_outline(pen, box->x + box->width / 2, box->y + box->height / 2, 0.4 * box->height, true);
        break;
    case ROW_ASSUMED:
        pen_ink(pen, 1);
        overlay_outline(pen, box->x + box->width / 2, box->y + box->height / 2, 0.27 * box->height, false);
        overlay_outline(pen, box->x + box->width / 2, box->y + box->height / 2, 0.47 * box->height, false);
        break;
    case ROW_ARROW: /* this row has no sample before its text: draw_longest() draws the arrow next to the text */ break;
    case ROW_NOWHERE: overlay_unknown_direction(pen, box->x + box->width / 2, box->y + box->height / 2); break;
    default:
        overlay_ring(pen, box->x + box->width / 2, box->y + box->height / 2, 0.5 * box->height, (int)row - ROW_ALARM + 1, ALARM_ACTIVE);
        break;
    }
}

static void draw_text(struct pen *pen, const struct legend *legend, double y, const char *text)
{
    pen_ink(pen, 0.95);
    pen_text(pen, legend->bar.x + legend->bar.width + 0.55 * pen->text_px, y + 0.92 * pen->text_px, text);
}

/* Draws the longest arrow into the legend, together with the value that it represents. */
static void draw_longest(struct pen *pen, const struct legend *legend, double y)
{
    double left = legend->card.x + legend->pad, long_px = overlay_arrow_px(pen);
    overlay_arrow(pen, left + 0.5 * long_px, y + 0.55 * pen->text_px, long_px, 0, false);
    pen_ink(pen, 0.95);
    pen_text(pen, left + long_px + 0.55 * pen->text_px, y + 0.92 * pen->text_px, legend->longest);
}

static void draw_rows(struct pen *pen, const struct legend *legend)
{
    double y = legend->bar.y + legend->bar.height + 0.55 * pen->text_px;
    pen_font(pen, 0.9, false);
    for (int i = 0; i < legend->row_count; i++, y += ROW * pen->text_px) {
        draw_swatch(pen, &(struct label_box){ legend->bar.x, y, legend->bar.width, 1.1 * pen->text_px }, legend->rows[i]);
        if (legend->rows[i] == ROW_ARROW)
            draw_longest(pen, legend, y);
        else
            draw_text(pen, legend, y, row_text(pen, legend, legend->rows[i]));
    }
    pen_ink(pen, 1);
    for (int i = 0; i < legend->note_count; i++)
        pen_text(pen, legend->card.x + legend->pad, y + (1.1 + NOTE * i) * pen->text_px, legend->notes[i]);
}

void overlay_legend(struct pen *pen)
{
    struct scale scale;
    struct legend legend = { .note_count = 0 };
    view_scale(pen->scene->plant, &pen->view, &scale);
    write_words(pen, &legend);
    lay_out(pen, &legend);
    pen_card(pen, &legend.card);
    pen_take(pen, &legend.card);
    pen_font(pen, 1, true);
    pen_ink(pen, 1);
    pen_text(pen, legend.card.x + legend.pad, legend.card.y + legend.pad + pen->text_px, legend.title);
    pen_font(pen, 0.9, false);
    if (legend.above[0]) {
        struct label_box above = { legend.bar.x, legend.bar.y - 1.65 * pen->text_px, legend.bar.width, 1.1 * pen->text_px };
        fill_box(pen, &above, scale.map->above);
        draw_text(pen, &legend, above.y, legend.above);
    }
    overlay_bar(pen, &legend.bar);
    draw_rows(pen, &legend);
}

static bool say_the_same(const struct legend *a, const struct legend *b)
{
    bool same = !strcmp(a->title, b->title) && !strcmp(a->above, b->above) && !strcmp(a->below, b->below) && a->row_count == b->row_count &&
                a->note_count == b->note_count;
    for (int i = 0; same && i < a->row_count; i++)
        same = a->rows[i] == b->rows[i];
    for (int i = 0; same && i < a->note_count; i++)
        same = !strcmp(a->notes[i], b->notes[i]);
    return same;
}

static bool are_the_same(const struct scale *a, const struct scale *b)
{
    return a->map == b->map && a->min == b->min && a->max == b->max && a->log == b->log && a->interval == b->interval &&
           a->break_count == b->break_count && !memcmp(a->breaks, b->breaks, (size_t)a->break_count * sizeof(*a->breaks));
}

bool overlay_legend_is_shared(struct pen *pen)
{
    struct legend legends[2] = { { .note_count = 0 } };
    struct scale scales[2];
    struct view left = { 0 };
    for (int half = 0; half < 2; half++) {
        if (half)
            left = pen->view;
        pen_choose_half(pen, half);
        write_words(pen, &legends[half]);
        view_scale(pen->scene->plant, &pen->view, &scales[half]);
    }
    const struct view *right = &pen->view;
    const struct color_scale *a = &left.color_scale, *b = &right->color_scale;
    return left.look != LOOK_MATERIALS && right->look != LOOK_MATERIALS && left.field.group == right->field.group &&
           left.field.show == right->field.show && say_the_same(&legends[0], &legends[1]) && are_the_same(&scales[0], &scales[1]) &&
           a->line_count == b->line_count && !memcmp(a->lines, b->lines, (size_t)a->line_count * sizeof(*a->lines));
}

double overlay_legend_width(struct pen *pen)
{
    struct legend legend = { .note_count = 0 };
    write_words(pen, &legend);
    lay_out(pen, &legend);
    return pen->area.x + pen->area.width - legend.card.x + legend.pad;
}
