/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws the arrows of a field that has directions, such as flow. An arrow's length shows the value; a cross marks an unknown direction. */
#include <math.h>

#include "render/overlay/overlay_pen.h"

#define HALO 0.85 /* opacity of the white halo that makes dark lines visible on every colour */

bool overlay_has_arrows(const struct pen *pen)
{
    const struct field_params *field = &pen->view.field;
    return pen->view.directions != DIRECTIONS_NONE && field->show == SHOW_VALUE && !field->trial &&
           pen->scene->plant->groups[field->group].directed;
}

double overlay_arrow_px(const struct pen *pen)
{
    return 0.95 * FRAME_ARROW_PX(pen->area.width);
}

double overlay_arrow_value(const struct pen *pen)
{
    return fmax(fabs(pen->view.range_min), fabs(pen->view.range_max));
}

static void stroke_both(struct pen *pen, double width, bool dashed)
{
    const double dash[2] = { 3 * pen->unit, 2.5 * pen->unit };
    cairo_set_line_cap(pen->cairo, CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(pen->cairo, CAIRO_LINE_JOIN_ROUND);
    cairo_set_source_rgba(pen->cairo, 1, 1, 1, HALO);
    cairo_set_line_width(pen->cairo, width + 2 * pen->unit);
    cairo_stroke_preserve(pen->cairo);
    cairo_set_dash(pen->cairo, dash, dashed ? 2 : 0, 0);
    pen_dark(pen, 1);
    cairo_set_line_width(pen->cairo, width);
    cairo_stroke(pen->cairo);
    cairo_set_dash(pen->cairo, NULL, 0, 0);
}

void overlay_arrow(struct pen *pen, double x, double y, double dx_px, double dy_px, bool uncertain)
{
    double length = hypot(dx_px, dy_px), head = fmin(7 * pen->unit, 0.5 * length);
    cairo_new_path(pen->cairo);
    if (length < 2 * pen->unit) {
        cairo_arc(pen->cairo, x, y, 1.6 * pen->unit, 0, 2 * M_PI);
        stroke_both(pen, pen->unit, false);
        return;
    }
    double ux = dx_px / length, uy = dy_px / length, tip_x = x + 0.5 * dx_px, tip_y = y + 0.5 * dy_px;
    cairo_move_to(pen->cairo, x - 0.5 * dx_px, y - 0.5 * dy_px);
    cairo_line_to(pen->cairo, tip_x, tip_y);
    for (int side = -1; side <= 1; side += 2) {
        cairo_move_to(pen->cairo, tip_x, tip_y);
        cairo_rel_line_to(pen->cairo, head * (-0.85 * ux - side * 0.5 * uy), head * (-0.85 * uy + side * 0.5 * ux));
    }
    stroke_both(pen, 1.6 * pen->unit, uncertain);
}

bool overlay_is_unknown_direction(const struct frame_label *label)
{
    return label->arrow && label->stroke == 0 && label->dx == 0 && label->dy == 0;
}

void overlay_unknown_direction(struct pen *pen, double x, double y)
{
    const double reach = 3 * pen->unit;
    cairo_new_path(pen->cairo);
    for (int side = -1; side <= 1; side += 2) {
        cairo_move_to(pen->cairo, x - reach, y - side * reach);
        cairo_line_to(pen->cairo, x + reach, y + side * reach);
    }
    stroke_both(pen, 1.6 * pen->unit, false);
}

/* Draws the stroke (short streamline) whose points begin at label `from`, with an arrowhead at its end. Returns the index of its last
   point. */
static size_t draw_stroke(struct pen *pen, size_t from)
{
    const struct frame_label *label = &pen->frame->labels[from], *last = label;
    const double head = 6 * pen->unit;
    size_t end = from + 1;
    bool uncertain = label->uncertain;
    cairo_new_path(pen->cairo);
    cairo_move_to(pen->cairo, (double)label->x_px, (double)label->y_px);
    for (; end < pen->frame->label_count && label[end - from].stroke == label->stroke && label[end - from].half == label->half; end++) {
        last = &label[end - from];
        uncertain |= last->uncertain;
        cairo_line_to(pen->cairo, (double)last->x_px, (double)last->y_px);
    }
    double ux = (double)last->dx, uy = (double)last->dy, length = hypot(ux, uy);
    for (int side = -1; side <= 1 && length > 0.1; side += 2) {
        cairo_move_to(pen->cairo, (double)last->x_px, (double)last->y_px);
        cairo_rel_line_to(pen->cairo, head * (-0.85 * ux - side * 0.5 * uy) / length, head * (-0.85 * uy + side * 0.5 * ux) / length);
    }
    stroke_both(pen, 1.6 * pen->unit, uncertain);
    return end - 1;
}

void overlay_arrows(struct pen *pen)
{
    double scale = overlay_arrow_px(pen) / overlay_arrow_value(pen);
    for (size_t i = 0; i < pen->frame->label_count && overlay_has_arrows(pen); i++) {
        const struct frame_label *label = &pen->frame->labels[i];
        double length = fmin(scale * fabs(label->value), overlay_arrow_px(pen));
        if (!label->arrow || label->half != pen->half)
            continue;
        if (label->stroke != 0)
            i = draw_stroke(pen, i);
        else if (overlay_is_unknown_direction(label))
            overlay_unknown_direction(pen, (double)label->x_px, (double)label->y_px);
        else
            overlay_arrow(pen, (double)label->x_px, (double)label->y_px, length * (double)label->dx, length * (double)label->dy,
                          label->uncertain);
    }
}
