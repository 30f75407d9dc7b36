/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Captions of a split view's halves: each lists how its half differs from the other in ways that the legends do not show. */
#include <math.h>
#include <string.h>

#include "render/overlay/overlay_pen.h"

enum { MAX_LINES = 10 };
struct caption { /* caption of one half */
    char lines[MAX_LINES][96];
    int count;
};

/* Adds a line to the caption of one half. word: text of the line, in which `value` replaces {}; value NULL: the text has no {}. */
static void add_line(struct caption *caption, const struct pen *pen, enum overlay_word word, const char *value)
{
    if (caption->count < MAX_LINES)
        pen_say(pen, word, value, NULL, caption->lines[caption->count++], sizeof(caption->lines[0]));
}

static void add_number(struct caption *caption, const struct pen *pen, enum overlay_word word, double value)
{
    char number[40];
    pen_number(value, fabs(value), number);
    add_line(caption, pen, word, number);
}

/* Lists the field parameters that differ between the views `own` and `other`, with the values of `own`, in the words of the page's
   options. */
static void write_caption(struct caption *caption, const struct pen *pen, const struct view *own, const struct view *other)
{
    const struct field_params *a = &own->field, *b = &other->field;
    caption->count = 0;
    if (own->look != other->look)
        add_line(caption, pen, (enum overlay_word)(WORD_LOOKS + (int)own->look), NULL);
    if (own->look == LOOK_MATERIALS || other->look == LOOK_MATERIALS)
        return;
    if (a->distance != b->distance)
        add_line(caption, pen, (enum overlay_word)(WORD_DISTANCES + (int)a->distance), NULL);
    if (a->show == SHOW_DISTANCE || a->show != b->show)
        return;
    if (a->interpolation != b->interpolation)
        add_line(caption, pen, (enum overlay_word)(WORD_INTERPOLATIONS + (int)a->interpolation), NULL);
    if (a->power != b->power && a->interpolation == INTERPOLATION_SHEPARD)
        add_number(caption, pen, WORD_POWER, a->power);
    if (a->strength != b->strength)
        add_number(caption, pen, WORD_STRENGTH, a->strength);
    if (a->decay != b->decay)
        add_number(caption, pen, WORD_DECAY, a->decay);
    if (a->radius_m != b->radius_m && a->interpolation == INTERPOLATION_PAPER)
        add_number(caption, pen, a->radius_m > 0 ? WORD_RADIUS : WORD_RADIUS_AUTOMATIC, a->radius_m);
    if (a->reach_m != b->reach_m)
        add_number(caption, pen, isfinite(a->reach_m) ? WORD_REACH : WORD_REACH_UNLIMITED, a->reach_m);
    if (a->fill != b->fill)
        add_line(caption, pen, a->fill == FILL_NONE ? WORD_NOT_FILLED : WORD_FILLED, NULL);
    /* true: both halves override the strength and decay of the same sensors with the same values; compared as in
       field_params_equal() */
    bool same_sensors = a->override_count == b->override_count &&
                        !memcmp(a->overrides, b->overrides, a->override_count * sizeof(*a->overrides));
    if (!same_sensors && a->override_count > 0)
        add_number(caption, pen, WORD_WEIGHTED, (double)a->override_count);
    else if (!same_sensors)
        add_line(caption, pen, WORD_AS_CONFIGURED, NULL);
}

/* Draws the caption in the upper left corner of its half, below what the overlay has already drawn there. */
static void draw_caption(struct pen *pen, const struct caption *caption)
{
    double pad = 8 * pen->unit, width = 0, line_px = 1.35 * pen->text_px;
    pen_font(pen, 1, true);
    for (int i = 0; i < caption->count; i++)
        width = fmax(width, pen_text_width(pen, caption->lines[i]));
    struct label_box box = { pen->area.x + pad, pen->area.y + pad, width + 2 * pad, line_px * caption->count + 1.4 * pad };
    for (int i = 0; i < pen->taken_count; i++)
        if (box_meets(&pen->taken[i], &box))
            box.y = pen->taken[i].y + pen->taken[i].height + pad;
    pen_card(pen, &box);
    pen_ink(pen, 1);
    for (int i = 0; i < caption->count; i++)
        pen_text(pen, box.x + pad, box.y + 0.7 * pad + (0.8 + i) * line_px, caption->lines[i]);
    pen_take(pen, &box);
}

void overlay_halves(struct pen *pen)
{
    struct caption caption;
    struct view other;
    for (int half = 0; half < 2; half++) {
        pen_choose_half(pen, half);
        view_half(&pen->frame->view, 1 - half, &other);
        write_caption(&caption, pen, &pen->view, &other);
        if (caption.count > 0)
            draw_caption(pen, &caption);
    }
}
