/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the halves of a split view differ in that no legend says: how the field is made. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

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

/* otherwise: where it is not given in metres. */
static void add_metres(struct caption *caption, const char *what, bool given, double value_m, const char *otherwise)
{
    char number[40];
    if (given) {
        pen_number(value_m, fabs(value_m), number);
        add_line(caption, "%s %s m", what, number);
    } else {
        add_line(caption, "%s %s", what, otherwise);
    }
}

/* What `own` has where `other` has something else, in the words of the options. */
static void write_caption(struct caption *caption, const struct view *own, const struct view *other)
{
    static const char *const looks[] = { "Default look", "Glossy look", "Flat look", "Materials" }; /* by enum look */
    static const char *const interpolations[INTERPOLATIONS] = { "Shepard", "Algorithm 1 of the paper", "Conduction along the wall",
                                                                "Conduction and loss to the air" };
    static const char *const distances[DISTANCES] = { "Geodesic distance", "Euclidean distance", "Geodesic distance by heat" };
    const struct field_params *a = &own->field, *b = &other->field;
    caption->count = 0;
    if (own->look != other->look)
        add_line(caption, "%s", looks[own->look]);
    if (own->look == LOOK_MATERIALS || other->look == LOOK_MATERIALS)
        return;
    if (a->distance != b->distance)
        add_line(caption, "%s", distances[a->distance]);
    if (a->show == SHOW_DISTANCE || a->show != b->show)
        return;
    if (a->interpolation != b->interpolation)
        add_line(caption, "%s", interpolations[a->interpolation]);
    if (a->power != b->power && a->interpolation == INTERPOLATION_SHEPARD)
        add_number(caption, "Power %s", a->power);
    if (a->strength != b->strength)
        add_number(caption, "Strength %s", a->strength);
    if (a->decay != b->decay)
        add_number(caption, "Decay %s", a->decay);
    if (a->radius_m != b->radius_m && a->interpolation == INTERPOLATION_PAPER)
        add_metres(caption, "Radius", a->radius_m > 0, a->radius_m, "automatic");
    if (a->reach_m != b->reach_m)
        add_metres(caption, "Reach", isfinite(a->reach_m), a->reach_m, "without limit");
    if (a->fill != b->fill)
        add_line(caption, a->fill == FILL_NONE ? "Not filled" : "Filled by neighbours");
    bool same_sensors = a->override_count == b->override_count && /* as field_params_equal has it */
                        !memcmp(a->overrides, b->overrides, a->override_count * sizeof(*a->overrides));
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
        write_caption(&caption, &pen->view, &other);
        if (caption.count > 0)
            draw_caption(pen, &caption);
    }
}
