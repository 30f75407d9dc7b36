/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the halves of a split view differ in that no legend says: how the field is made. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "render/overlay/overlay_pen.h"

enum { LINES = 10 };
struct caption { /* of one half */
    char lines[LINES][64];
    int count;
};

__attribute__((format(printf, 2, 3))) static void add_line(struct caption *caption, const char *form, ...)
{
    va_list args;
    va_start(args, form);
    if (caption->count < LINES)
        vsnprintf(caption->lines[caption->count++], sizeof(caption->lines[0]), form, args);
    va_end(args);
}

static void add_number(struct caption *caption, const char *form, double value)
{
    char number[40];
    pen_number(value, fabs(value), number);
    add_line(caption, form, number);
}

/* What `own` has where `other` has something else, in the words of the options. */
static void write_caption(struct caption *caption, const struct view *own, const struct view *other)
{
    static const char *const looks[] = { "Default look", "Glossy look", "Flat look", "Materials" }; /* by enum look */
    const struct field_params *a = &own->field, *b = &other->field;
    bool blends = a->show == SHOW_VALUE || a->show == SHOW_DIFFERENCE || a->show == SHOW_OPERATOR;
    caption->count = 0;
    if (own->look != other->look)
        add_line(caption, "%s", looks[own->look]);
    if (own->look == LOOK_MATERIALS || other->look == LOOK_MATERIALS)
        return;
    if (a->distance != b->distance)
        add_line(caption, "%s distance", a->distance == DISTANCE_GEODESIC ? "Geodesic" : "Euclidean");
    if (!blends || a->show != b->show)
        return;
    if (a->interpolation != b->interpolation)
        add_line(caption, "%s", a->interpolation == INTERPOLATION_PAPER ? "Algorithm 1 of the paper" : "Shepard");
    if (a->power != b->power && a->interpolation == INTERPOLATION_SHEPARD)
        add_number(caption, "Power %s", a->power);
    if (a->strength != b->strength)
        add_number(caption, "Strength %s", a->strength);
    if (a->decay != b->decay)
        add_number(caption, "Decay %s", a->decay);
    if (a->radius_m != b->radius_m && a->interpolation == INTERPOLATION_PAPER && a->radius_m > 0)
        add_number(caption, "Radius %s m", a->radius_m);
    else if (a->radius_m != b->radius_m && a->interpolation == INTERPOLATION_PAPER)
        add_line(caption, "Radius automatic");
    if (a->reach_m != b->reach_m && isfinite(a->reach_m))
        add_number(caption, "Reach %s m", a->reach_m);
    else if (a->reach_m != b->reach_m)
        add_line(caption, "Reach without limit");
    if (a->fill != b->fill)
        add_line(caption, a->fill == FILL_NONE ? "Not filled" : "Filled by neighbours");
    bool same_sensors = a->override_count == b->override_count;
    for (size_t i = 0; i < a->override_count && same_sensors; i++)
        same_sensors = a->overrides[i].tag == b->overrides[i].tag && a->overrides[i].strength == b->overrides[i].strength &&
                       a->overrides[i].decay == b->overrides[i].decay;
    if (!same_sensors && a->override_count > 0)
        add_line(caption, "Sensors weighted by hand: %zu", a->override_count);
    else if (!same_sensors)
        add_line(caption, "Sensors as configured");
}

/* In the upper left corner; below what lies there. */
static void draw_caption(struct pen *pen, const struct caption *caption)
{
    double pad = 8 * pen->unit, width = 0, line_px = 1.35 * pen->text_px;
    pen_font(pen, 1, true);
    for (int i = 0; i < caption->count; i++)
        width = fmax(width, pen_text_width(pen, caption->lines[i]));
    struct box box = { pen->area.x + pad, pen->area.y + pad, width + 2 * pad, line_px * caption->count + 1.4 * pad };
    for (int i = 0; i < pen->taken_count; i++)
        if (box_meets(&pen->taken[i], &box))
            box.y = pen->taken[i].y + pen->taken[i].height + pad;
    pen_card(pen, &box);
    pen_ink(pen, 1);
    for (int i = 0; i < caption->count; i++)
        pen_text(pen, box.x + pad, box.y + 0.7 * pad + (0.8 + 1.0 * i) * line_px, caption->lines[i]);
    pen_take(pen, &box);
}

void overlay_halves(struct pen *pen)
{
    struct caption caption;
    struct view other;
    for (int half = 0; half < 2; half++) {
        pen_choose_half(pen, half);
        view_half(&pen->frame->view, 1 - half, &other);
        write_caption(&caption, &pen->view, &other);
        if (caption.count > 0)
            draw_caption(pen, &caption);
    }
}
