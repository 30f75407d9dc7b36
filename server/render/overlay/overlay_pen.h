/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the parts of the overlay draw with. Sizes grow with the picture: `unit` is one pixel at 1280x720. */
#ifndef RENDER_OVERLAY_PEN_H
#define RENDER_OVERLAY_PEN_H
#include <stdbool.h>

#include <cairo.h>

#include "loopcheck/loop_checks.h"
#include "render/frame.h"
#include "render/overlay/labels.h"
#include "value/alarm.h"

bool box_meets(const struct box *a, const struct box *b);

enum { PEN_MAX_TAKEN = 512 };
struct pen {
    cairo_t *cairo;
    const struct frame *frame;
    struct view view; /* of the half that is drawn over */
    int half;         /* of a split view; else 0 */
    struct box area;  /* that half */
    const struct scene *scene;
    const struct snapshot *snapshot;
    const struct loop_checks *loop_checks; /* NULL: none */
    bool bare;                             /* nothing of sensors and alarms */
    double unit, text_px;
    struct box taken[PEN_MAX_TAKEN]; /* where nothing more may be put */
    int taken_count;
};

void pen_choose_half(struct pen *pen, int half);                /* what is drawn over from now on */
bool pen_is_free(const struct pen *pen, const struct box *box); /* inside the area, and over nothing that is taken */
void pen_take(struct pen *pen, const struct box *box);
void pen_card(struct pen *pen, const struct box *box); /* a light plate with a thin rim, for text to stand on */
void pen_rgb(struct pen *pen, const uint8_t rgb[3]);
void pen_ink(struct pen *pen, double alpha);            /* the colour of text */
void pen_font(struct pen *pen, double size, bool bold); /* size: of text_px */
double pen_text_width(struct pen *pen, const char *text);
void pen_text(struct pen *pen, double x, double y, const char *text); /* from x, on a line through y; left where it starts */

/* As few decimals as tell it apart from what differs by a 5000th of the range. */
void pen_number(double value, double range, char out[40]);
/* How many decimals tell values apart that differ by a 500th of the range. */
int pen_decimals(double range);
double pen_rounded(double value, int decimals); /* to print with so many: 0 where that would be -0 */

/* The scale of pen->view: colours from MIN at the bottom to MAX at the top, ticks to the right, the group's limits to the left. */
void overlay_bar(struct pen *pen, const struct box *bar);
double overlay_bar_width(struct pen *pen); /* with all that is written beside it */
double overlay_bar_left(struct pen *pen);  /* of which before the bar itself */
void overlay_legend(struct pen *pen);
bool overlay_legend_is_shared(struct pen *pen); /* of a split view: both halves' say the same. Chooses the right half */
double overlay_legend_width(struct pen *pen);   /* what it takes of the area, with its margins */
/* Draws, in each half of a split view, a caption of what it shows otherwise than the other half, where no legend says so. The view must be
   split. Leaves the pen on the right half (pen_choose_half). */
void overlay_halves(struct pen *pen);
/* A mark's outline: broken where its tag is unproven. */
void overlay_outline(struct pen *pen, double x, double y, double radius, bool broken);
bool overlay_unproven(const struct pen *pen, int tag);
/* Around a place with an alarm: its colour says the priority, its form how it is. Thick: it calls; thin: it is acknowledged;
   hollow: its cause is gone. */
void overlay_ring(struct pen *pen, double x, double y, double radius, int priority, enum alarm_status word);
void overlay_markers(struct pen *pen);
/* Within the half that is chosen, with nothing before it, and under nothing that was drawn over the picture so far. */
bool overlay_marker_seen(const struct pen *pen, const struct frame_marker *marker);
/* Active alarms of the whole plant that no mark in the picture shows, the gravest first. */
void overlay_alarms(struct pen *pen);

#endif
