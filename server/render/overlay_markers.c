/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sensors: a mark at each place, and a label wherever it covers nothing else. */
#include <math.h>
#include <stdio.h>

#include "base/mem.h"
#include "render/overlay_pen.h"
#include "value/alarms.h"
#include "value/quality.h"

static const double LABELS_PART = 0.05; /* of the picture may lie under labels: a hundred would hide the plant */

struct labels {
    double room_px;
    bool *done; /* by marker */
};

/* Filled: in sight. Hollow: something stands before it. Crossed: bad. */
static void draw_mark(struct pen *pen, const struct frame_marker *marker, bool bad)
{
    double radius = 4.2 * pen->unit, x = marker->x_px, y = marker->y_px;
    cairo_new_path(pen->cairo);
    cairo_arc(pen->cairo, x, y, radius, 0, 2 * M_PI);
    cairo_set_source_rgba(pen->cairo, 1, 1, 1, marker->occluded ? 0.35 : 0.95);
    cairo_fill_preserve(pen->cairo);
    pen_ink(pen, marker->occluded ? 0.7 : 1);
    cairo_set_line_width(pen->cairo, fmax(1.2, 1.6 * pen->unit));
    cairo_stroke(pen->cairo);
    if (bad) {
        double arm = 0.62 * radius;
        cairo_move_to(pen->cairo, x - arm, y - arm);
        cairo_line_to(pen->cairo, x + arm, y + arm);
        cairo_move_to(pen->cairo, x - arm, y + arm);
        cairo_line_to(pen->cairo, x + arm, y - arm);
        cairo_stroke(pen->cairo);
    } else if (!marker->occluded) {
        cairo_arc(pen->cairo, x, y, 0.45 * radius, 0, 2 * M_PI);
        cairo_fill(pen->cairo);
    }
}

void overlay_ring(struct pen *pen, double x, double y, double radius, int alarm)
{
    static const double red[3] = { 0.78, 0.06, 0.10 }, amber[3] = { 0.95, 0.66, 0.05 };
    const double *color = alarm == LIMIT_HH || alarm == LIMIT_LL ? red : amber;
    cairo_new_path(pen->cairo);
    cairo_arc(pen->cairo, x, y, radius, 0, 2 * M_PI);
    pen_ink(pen, 0.9);
    cairo_set_line_width(pen->cairo, fmax(3.2, 0.55 * radius));
    cairo_stroke_preserve(pen->cairo);
    cairo_set_source_rgb(pen->cairo, color[0], color[1], color[2]);
    cairo_set_line_width(pen->cairo, fmax(2.0, 0.38 * radius));
    cairo_stroke(pen->cairo);
}

/* ALARM_NONE but in the operator's view: elsewhere alarm colours might be taken for values. */
static int alarm_of(const struct pen *pen, const struct frame_marker *marker)
{
    if (!view_is_operator(&pen->view))
        return ALARM_NONE;
    return alarm_active(&pen->scene->plant->tags[marker->tag], &pen->snapshot->readings[marker->tag]);
}

static void format_value(const struct pen *pen, const struct frame_marker *marker, char out[64])
{
    const struct reading *reading = &pen->snapshot->readings[marker->tag];
    const struct plant_tag *tag = &pen->scene->plant->tags[marker->tag];
    const struct plant_group *group = &pen->scene->plant->groups[pen->view.field.group];
    int alarm = alarm_of(pen, marker);
    if (quality_is_bad(reading->quality))
        snprintf(out, 64, "BAD");
    else
        snprintf(out, 64, "%.*f %s%s%s%s", pen_decimals(group->max - group->min), reading->value, tag->unit ? tag->unit : "",
                 quality_is_uncertain(reading->quality) ? " ?" : "", alarm == ALARM_NONE ? "" : " ",
                 alarm == ALARM_NONE ? "" : alarm_name(alarm));
}

static void draw_label(struct pen *pen, const struct box *box, const char *name, double name_width, const char *value, bool occluded)
{
    double pad = 4 * pen->unit;
    pen_card(pen, box);
    pen_font(pen, 0.85, false);
    pen_ink(pen, occluded ? 0.6 : 0.85);
    pen_text(pen, box->x + pad, box->y + pad + 0.72 * pen->text_px, name);
    pen_font(pen, 0.85, true);
    pen_text(pen, box->x + pad + name_width, box->y + pad + 0.72 * pen->text_px, value);
}

/* Tries the places around the mark, nearest first. False: none is free. */
static bool place_label(struct pen *pen, const struct frame_marker *marker, struct labels *labels)
{
    static const double places[8][2] = { { 1, -0.5 },  { -1, -0.5 }, { 1, -1.3 }, { 1, 0.3 },
                                         { -1, -1.3 }, { -1, 0.3 },  { 0, -1.9 }, { 0, 0.9 } };
    char name[140], value[64];
    double pad = 4 * pen->unit, gap = 8 * pen->unit;
    format_value(pen, marker, value);
    snprintf(name, sizeof(name), "%s  ", pen->scene->plant->tags[marker->tag].name);
    pen_font(pen, 0.85, false);
    double name_width = pen_text_width(pen, name);
    pen_font(pen, 0.85, true);
    struct box box = { .width = name_width + pen_text_width(pen, value) + 2 * pad, .height = 0.95 * pen->text_px + 2 * pad };
    for (int i = 0; i < 8; i++) {
        box.x = marker->x_px + places[i][0] * gap - (places[i][0] < 0 ? box.width : places[i][0] == 0 ? 0.5 * box.width : 0);
        box.y = marker->y_px + places[i][1] * box.height;
        if (!pen_is_free(pen, &box))
            continue;
        pen_take(pen, &box);
        labels->room_px -= box.width * box.height;
        draw_label(pen, &box, name, name_width, value, marker->occluded);
        return true;
    }
    return false;
}

static bool is_bad(const struct pen *pen, const struct frame_marker *marker)
{
    return quality_is_bad(pen->snapshot->readings[marker->tag].quality);
}

static bool is_inside(const struct pen *pen, const struct frame_marker *marker)
{
    const struct box *area = &pen->area;
    return marker->half == pen->half && marker->x_px >= area->x && marker->y_px >= 0 && marker->x_px < area->x + area->width &&
           marker->y_px < area->height;
}

/* Alarms and bad ones first, then those in sight: a hidden sensor must not take their place. */
static int rank_of(const struct pen *pen, const struct frame_marker *marker)
{
    return (is_bad(pen, marker) || alarm_of(pen, marker) != ALARM_NONE) && !marker->occluded ? 0 : marker->occluded ? 2 : 1;
}

static bool is_apart(const struct pen *pen, const struct labels *labels, const struct frame_marker *marker, double least_px)
{
    for (size_t i = 0; i < pen->frame->marker_count; i++)
        if (labels->done[i] && hypot(pen->frame->markers[i].x_px - marker->x_px, pen->frame->markers[i].y_px - marker->y_px) < least_px)
            return false;
    return true;
}

/* Far apart at first, then in between, so that every part of the plant gets some. */
static void place_labels(struct pen *pen)
{
    static const double spacings[] = { 0.16, 0.08, 0 }; /* of the area's width */
    const struct frame *frame = pen->frame;
    struct labels labels = { .room_px = LABELS_PART * pen->area.width * pen->area.height };
    labels.done = mem_array(frame->marker_count, sizeof(*labels.done));
    for (int rank = 0; rank < 3; rank++)
        for (int pass = 0; pass < 3; pass++)
            for (size_t i = 0; i < frame->marker_count && labels.room_px > 0; i++) {
                const struct frame_marker *marker = &frame->markers[i];
                if (!labels.done[i] && rank_of(pen, marker) == rank && is_inside(pen, marker) &&
                    is_apart(pen, &labels, marker, spacings[pass] * pen->area.width))
                    labels.done[i] = place_label(pen, marker, &labels);
            }
    mem_free(labels.done);
}

static bool is_under(const struct pen *pen, int cards, const struct box *mark)
{
    for (int i = 0; i < cards; i++)
        if (box_meets(&pen->taken[i], mark))
            return true;
    return false;
}

/* The value on its line, wherever nothing else is; those of one value stand far apart. */
static void label_isolines(struct pen *pen)
{
    const struct frame *frame = pen->frame;
    double least_px = 0.16 * pen->area.width, range = pen->view.range_max - pen->view.range_min, pad = 2 * pen->unit;
    bool *done = mem_array(frame->label_count, sizeof(*done));
    for (size_t i = 0; i < frame->label_count && !view_is_operator(&pen->view); i++) {
        const struct frame_label *label = &frame->labels[i];
        bool crowded = label->half != pen->half;
        for (size_t k = 0; k < i && !crowded; k++)
            crowded = done[k] && frame->labels[k].value == label->value &&
                      hypot(frame->labels[k].x_px - label->x_px, frame->labels[k].y_px - label->y_px) < least_px;
        char text[40];
        pen_number(label->value, pen->view.paint.log ? label->value : range, text);
        pen_font(pen, 0.75, true);
        double width = pen_text_width(pen, text) + 2 * pad, height = 0.75 * pen->text_px + 2 * pad;
        struct box box = { label->x_px - 0.5 * width, label->y_px - 0.5 * height, width, height };
        if (crowded || !pen_is_free(pen, &box))
            continue;
        done[i] = true;
        pen_take(pen, &box);
        cairo_rectangle(pen->cairo, box.x, box.y, box.width, box.height);
        cairo_set_source_rgba(pen->cairo, 1, 1, 1, 0.75);
        cairo_fill(pen->cairo);
        pen_ink(pen, 1);
        pen_text(pen, box.x + pad, box.y + pad + 0.66 * pen->text_px, text);
    }
    mem_free(done);
}

void overlay_markers(struct pen *pen)
{
    int cards = pen->taken_count; /* what lies over the picture already */
    double radius = 5 * pen->unit;
    for (size_t i = 0; i < pen->frame->marker_count; i++) {
        const struct frame_marker *marker = &pen->frame->markers[i];
        struct box mark = { marker->x_px - radius, marker->y_px - radius, 2 * radius, 2 * radius };
        if (!is_inside(pen, marker) || is_under(pen, cards, &mark))
            continue;
        if (!marker->occluded)
            pen_take(pen, &mark);
        if (alarm_of(pen, marker) != ALARM_NONE)
            overlay_ring(pen, marker->x_px, marker->y_px, 9.5 * pen->unit, alarm_of(pen, marker));
        draw_mark(pen, marker, is_bad(pen, marker));
    }
    place_labels(pen);
    label_isolines(pen);
}
