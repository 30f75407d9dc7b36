/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pen: the drawing context shared by all overlay files. Sizes scale with the frame: `unit` is one pixel at 1280x720. Call
   from any thread; one pen belongs to one thread. */
#ifndef RENDER_OVERLAY_PEN_H
#define RENDER_OVERLAY_PEN_H
#include <stdbool.h>

#include <cairo.h>

#include "loopcheck/loop_checks.h"
#include "render/frame.h"
#include "render/overlay/labels.h"
#include "render/overlay/overlay_words.h"
#include "value/alarm.h"

bool box_meets(const struct label_box *a, const struct label_box *b);

enum { PEN_MAX_TAKEN = 512 };
struct pen {
    cairo_t *cairo;
    const struct frame *frame;
    struct view view;      /* view that the pen draws: the whole view, or the selected half of a split view, as a view of its own */
    int half;              /* index of the half of a split view that is being drawn: 0 left, 1 right; 0 if the view is not split */
    struct label_box area; /* area of the half being drawn, above the legend strip, in pixels of the frame */
    const struct scene *scene;
    const struct snapshot *snapshot;
    const struct loop_checks *loop_checks; /* NULL: none */
    bool bare;                             /* true: markers, sensor labels and alarms are not drawn */
    double unit, text_px;
    struct label_box taken[PEN_MAX_TAKEN]; /* occupied areas */
    int taken_count;
};

/* Selects the half of a split view in which the following calls draw. */
void pen_choose_half(struct pen *pen, int half);
/* Returns whether a box lies inside the pen's area and overlaps no occupied box. */
bool pen_is_free(const struct pen *pen, const struct label_box *box);
/* Marks a box as occupied. */
void pen_take(struct pen *pen, const struct label_box *box);
/* Draws a card with a thin border, as a background for text: light or dark, like the backdrop. */
void pen_card(struct pen *pen, const struct label_box *box);
/* Sets cairo's current path to the outline of a box with rounded corners. */
void pen_rounded_path(struct pen *pen, const struct label_box *box);
/* pen_rgb sets an sRGB colour. pen_ink sets the colour of text on cards. pen_dark sets the colour of markers and lines, which have light
   rims. */
void pen_rgb(struct pen *pen, const uint8_t rgb[3]);
void pen_ink(struct pen *pen, double alpha);
void pen_dark(struct pen *pen, double alpha);
/* Sets the font for all text drawn from now on. size: a multiple of the overlay's font size (text_px). */
void pen_font(struct pen *pen, double size, bool bold);
/* Returns the width of a text in the current font. */
double pen_text_width(struct pen *pen, const char *text);
/* Draws text that starts at x and is centred on y. */
void pen_text(struct pen *pen, double x, double y, const char *text);

/* pen_word returns a word, pen_say writes a sentence, in the language of the view (overlay_words.h). */
const char *pen_word(const struct pen *pen, enum overlay_word word);
void pen_say(const struct pen *pen, enum overlay_word word, const char *a, const char *b, char *out, size_t size);

/* Formats a value with as few decimals as possible, but enough to show differences of 1/5000 of `range`. */
void pen_number(double value, double range, char out[40]);
/* Returns the number of decimals that are needed to show differences of 1/500 of the group's range, or, if the group's colour
   scale is logarithmic, of 1/500 of the value: values near the lower end may be far smaller than the range. */
int pen_decimals(const struct plant_group *group, double value);
/* Returns the value rounded to this many decimals, and 0 instead of -0. */
double pen_rounded(double value, int decimals);

/* Draws the colour bar of pen->view: MIN at the bottom and MAX at the top, tick labels on its right, and the group's alarm
   limits on its left. */
void overlay_bar(struct pen *pen, const struct label_box *bar);
/* overlay_bar_width returns the width of the colour bar with the texts on both sides, overlay_bar_left the width of the text to its
   left. */
double overlay_bar_width(struct pen *pen);
double overlay_bar_left(struct pen *pen);
/* Returns the height in pixels of the frame's machine-readable legend strip. 0: the frame gets none, because its view does not ask for
   one or shows materials (LOOK_MATERIALS), or because the frame is too small. */
int overlay_strip_height(const struct frame *frame);
/* Writes the machine-readable legend strip over the lowest rows of the frame, if it gets one. bgrx: the frame's pixels. */
void overlay_strip(struct pen *pen, uint8_t *bgrx, int stride_bytes);
/* Draws the legend of the half that pen_choose_half() selected, or of the whole view if it is not split. */
void overlay_legend(struct pen *pen);
/* Returns whether both halves of a split view have equal legends. Afterwards the pen draws on the right half. */
bool overlay_legend_is_shared(struct pen *pen);
/* Returns the width of the legend in pixels, with the margins around it. */
double overlay_legend_width(struct pen *pen);
/* Draws a caption in each half of a split view: the caption lists how the half differs from the other, except what the legends show. The
   view must be split. Afterwards the pen draws on the right half (pen_choose_half). */
void overlay_halves(struct pen *pen);
/* Draws the outline of a marker. broken: dashed, for a tag that no loop check has proven. */
void overlay_outline(struct pen *pen, double x, double y, double radius, bool broken);
/* Returns true if the pen has loop checks but none has proven the tag's wiring; the marker is then drawn dashed. */
bool overlay_unproven(const struct pen *pen, int tag);
/* Draws an alarm ring. The colour shows the priority, the form the state: thick: unacknowledged; thin: acknowledged; hollow: returned to
   normal but not acknowledged. */
void overlay_ring(struct pen *pen, double x, double y, double radius, int priority, enum alarm_status word);
/* Returns whether the half that pen_choose_half() selected (the whole view, if it is not split) shows arrows. */
bool overlay_has_arrows(const struct pen *pen);
/* overlay_arrow_px returns the length of the longest arrow in pixels, overlay_arrow_value the value that this length represents. */
double overlay_arrow_px(const struct pen *pen);
double overlay_arrow_value(const struct pen *pen);
/* Draws an arrow centred on (x, y), or a dot if its length is 0. uncertain: dashed. */
void overlay_arrow(struct pen *pen, double x, double y, double dx_px, double dy_px, bool uncertain);
/* Returns whether the label is an arrow of unknown direction, which is drawn as a cross. */
bool overlay_is_unknown_direction(const struct frame_label *label);
/* Draws a cross at the position of an arrow whose direction is unknown. */
void overlay_unknown_direction(struct pen *pen, double x, double y);
/* Draws the symbols for directions (arrows, strokes and crosses) in the half that pen_choose_half() selected, or in the whole
   view if it is not split. */
void overlay_arrows(struct pen *pen);
/* Draws markers, alarm rings and labels of the selected half. cards: number of boxes that were occupied before the markers of any half
   were drawn: cards of the overlay (such as the legend) and banners. */
void overlay_markers(struct pen *pen, int cards);
/* Returns whether a marker is within the selected half, and neither the plant, nor the overlay drawn so far, nor `card` hides it. */
bool overlay_marker_seen(const struct pen *pen, const struct frame_marker *marker, const struct label_box *card);
/* Lists active alarms of the whole plant that no marker in the frame shows, most severe first. */
void overlay_alarms(struct pen *pen);

#endif
