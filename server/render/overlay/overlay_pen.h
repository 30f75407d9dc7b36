/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The drawing context shared by the parts of the overlay. Sizes scale with the picture: `unit` is one pixel at 1280x720.
   Thread: any; one pen belongs to one thread. */
#ifndef RENDER_OVERLAY_PEN_H
#define RENDER_OVERLAY_PEN_H
#include <stdbool.h>

#include <cairo.h>

#include "loopcheck/loop_checks.h"
#include "plant/walls/burn_shift.h"
#include "render/frame.h"
#include "render/overlay/labels.h"
#include "render/overlay/overlay_words.h"
#include "value/alarm.h"

bool box_meets(const struct label_box *a, const struct label_box *b);

enum { PEN_MAX_TAKEN = 512 };
struct pen {
    cairo_t *cairo;
    const struct frame *frame;
    struct view view; /* of the half being drawn */
    int half;         /* of a split view; else 0 */
    struct label_box area; /* area of that half, in pixels */
    const struct scene *scene;
    const struct snapshot *snapshot;
    const struct loop_checks *loop_checks; /* NULL: none */
    bool bare;                             /* draws nothing about sensors and alarms */
    bool calm;                             /* only what is abnormal has a label */
    double unit, text_px;
    struct burn_shift legend_shift;  /* of the legend, within the margin around it */
    struct label_box taken[PEN_MAX_TAKEN]; /* occupied areas */
    int taken_count;
};

/* Makes a half of a split view the one to draw over. */
void pen_choose_half(struct pen *pen, int half);
/* Returns whether a box lies inside the area and covers nothing that is taken. */
bool pen_is_free(const struct pen *pen, const struct label_box *box);
/* Marks a box as taken. */
void pen_take(struct pen *pen, const struct label_box *box);
/* Draws a light card with a thin border, as a background for text. */
void pen_card(struct pen *pen, const struct label_box *box);
/* Set the colour: any sRGB colour; that of text. */
void pen_rgb(struct pen *pen, const uint8_t rgb[3]);
void pen_ink(struct pen *pen, double alpha);
/* Sets the font. size: a multiple of text_px. */
void pen_font(struct pen *pen, double size, bool bold);
/* Returns the width of a text in the current font. */
double pen_text_width(struct pen *pen, const char *text);
/* Draws text that starts at x and is centred on y. */
void pen_text(struct pen *pen, double x, double y, const char *text);

/* Return a word, and write a sentence, in the language of the picture (overlay_words.h). */
const char *pen_word(const struct pen *pen, enum overlay_word word);
void pen_say(const struct pen *pen, enum overlay_word word, const char *a, const char *b, char *out, size_t size);

/* Prints a value with as few decimals as tell apart values that differ by a 5000th of the range. */
void pen_number(double value, double range, char out[40]);
/* Returns how many decimals tell apart values that differ by a 500th of the range. */
int pen_decimals(double range);
/* Returns the value rounded to so many decimals, and 0 instead of -0. */
double pen_rounded(double value, int decimals);

/* Draws the colour bar of pen->view: MIN at the bottom, MAX at the top, ticks on the right, the group's limits on the left. */
void overlay_bar(struct pen *pen, const struct label_box *bar);
/* Return the width of the colour bar with all text beside it, and the part of it that is left of the bar itself. */
double overlay_bar_width(struct pen *pen);
double overlay_bar_left(struct pen *pen);
/* Returns the height in pixels of the legend strip of a picture of that size; 0: it has none, being too small. */
int overlay_strip_height(int width_px, int height_px);
/* Writes the legend strip over the lowest rows of the picture, where it is wide and high enough. bgrx: the frame's pixels. */
void overlay_strip(struct pen *pen, uint8_t *bgrx, int stride_bytes);
/* Draws the legend of the half that is chosen. */
void overlay_legend(struct pen *pen);
/* Returns whether the legends of both halves of a split view are the same. Leaves the pen on the right half. */
bool overlay_legend_is_shared(struct pen *pen);
/* Returns the width of the legend with its margins. */
double overlay_legend_width(struct pen *pen);
/* Draws, in each half of a split view, a caption of what it shows otherwise than the other half, where no legend says so. The view must be
   split. Leaves the pen on the right half (pen_choose_half). */
void overlay_halves(struct pen *pen);
/* Draws the outline of a marker. broken: dashed, for a tag that no loop check has proven. */
void overlay_outline(struct pen *pen, double x, double y, double radius, bool broken);
/* Returns whether loop checks are given and none has proven the tag. */
bool overlay_unproven(const struct pen *pen, int tag);
/* Draws an alarm ring. Its colour is the priority, its form the state: thick, unacknowledged; thin, acknowledged; hollow, returned to
   normal but not acknowledged. */
void overlay_ring(struct pen *pen, double x, double y, double radius, int priority, enum alarm_status word);
/* Returns whether the half that is chosen has arrows. */
bool overlay_has_arrows(const struct pen *pen);
/* Return how long the longest arrow is, in pixels, and the value that is as long. */
double overlay_arrow_px(const struct pen *pen);
double overlay_arrow_value(const struct pen *pen);
/* Draws an arrow with its middle at (x, y); a dot where it has no length. uncertain: dashed. */
void overlay_arrow(struct pen *pen, double x, double y, double dx_px, double dy_px, bool uncertain);
/* Returns whether a cross stands for this label: an arrow whose direction is not known. */
bool overlay_is_unknown_direction(const struct frame_label *label);
/* Draws the cross that stands where a direction is not known. */
void overlay_unknown_direction(struct pen *pen, double x, double y);
/* Draws the arrows of the half that is chosen. */
void overlay_arrows(struct pen *pen);
/* Draws markers, alarm rings and labels of the half that is chosen. */
void overlay_markers(struct pen *pen);
/* Returns whether a marker lies in the chosen half, is not hidden by the plant, and is not covered by the overlay drawn so far. */
bool overlay_marker_seen(const struct pen *pen, const struct frame_marker *marker);
/* Lists active alarms of the whole plant that no marker in the picture shows, gravest first. */
void overlay_alarms(struct pen *pen);

#endif
