/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws the overlay's header and banners, and calls the other overlay files to draw legend, markers and alarms. */
#include "render/overlay/overlay.h"

#include <math.h>
#include <stdio.h>
#include <time.h>

#include "base/clock.h"
#include "base/mem.h"
#include "render/overlay/overlay_pen.h"
#include "value/quality.h"

enum { AGE_BYTES = 80 };

static void format_age(const struct pen *pen, int64_t age_ns, char out[AGE_BYTES])
{
    double age_s = (double)age_ns / NS_PER_S;
    bool in_hours = age_s >= 7200, in_minutes = !in_hours && age_s >= 120;
    char number[40];
    snprintf(number, sizeof(number), age_s < 10 ? "%.1f" : "%.0f", in_hours ? age_s / 3600 : in_minutes ? age_s / 60 : age_s);
    pen_say(pen, in_hours ? WORD_OLD_H : in_minutes ? WORD_OLD_MIN : WORD_OLD_S, number, NULL, out, AGE_BYTES);
}

enum { CLOCK_BYTES = 64 };

/* Formats a time in the plant's time zone. */
static void format_clock(int64_t utc_ns, char out[CLOCK_BYTES])
{
    time_t seconds = (time_t)(utc_ns / NS_PER_S);
    struct tm local;
    out[0] = 0;
    if (localtime_r(&seconds, &local))
        strftime(out, CLOCK_BYTES, "%Y-%m-%d %H:%M:%S %Z", &local);
}

static bool is_shown(const struct view *view, int group)
{
    return group == view->field.group || (view->split && group == view->right.field.group);
}

static bool shows_simulated(const struct pen *pen)
{
    const struct plant *plant = pen->scene->plant;
    for (size_t i = 0; i < plant->tag_count; i++)
        if (is_shown(&pen->frame->view, plant->tags[i].group) && plant_tag_simulated(plant, (int)i))
            return true;
    return false;
}

/* Returns the height of the header: the plant's name, and `lines` lines of small text. */
static double header_height(const struct pen *pen, int lines)
{
    return (1.25 + 1.35 * lines) * pen->text_px + 12 * pen->unit;
}

/* Draws the header: the plant's name, its clock, and the age of the oldest reading used. Warnings (clock not set, simulated values) get a
   line of their own, which keeps the header narrow. */
static void draw_header(struct pen *pen)
{
    char clock[CLOCK_BYTES], lines[2][160], age[AGE_BYTES];
    format_clock(pen->frame->data_utc_ns, clock);
    if (pen->frame->view.at_us)
        pen_say(pen, WORD_CONFIGURATION, pen->scene->plant->files.hash, NULL, age, sizeof(age));
    else if (pen->frame->oldest_age_ns != INT64_MAX)
        format_age(pen, pen->frame->oldest_age_ns, age);
    else
        snprintf(age, sizeof(age), "%s", pen_word(pen, WORD_NO_VALUES));
    bool has_age = view_shows_readings(&pen->frame->view);
    bool unset = pen->frame->clock_unset, simulated = has_age && shows_simulated(pen);
    snprintf(lines[0], sizeof(lines[0]), "%s%s%s", clock, has_age ? "  ·  " : "", has_age ? age : "");
    snprintf(lines[1], sizeof(lines[1]), "%s%s%s", unset ? pen_word(pen, WORD_CLOCK_UNSET) : "", unset && simulated ? "  ·  " : "",
             simulated ? pen_word(pen, WORD_SIMULATED) : "");
    int count = lines[1][0] ? 2 : 1;
    double pad = 8 * pen->unit;
    pen_font(pen, 1.15, true);
    double width = pen_text_width(pen, pen->scene->plant->name);
    pen_font(pen, 0.92, false);
    for (int i = 0; i < count; i++)
        width = fmax(width, pen_text_width(pen, lines[i]));
    struct label_box box = { pad, pad, width + 2 * pad, header_height(pen, count) };
    pen_card(pen, &box);
    pen_ink(pen, 1);
    pen_font(pen, 1.15, true);
    pen_text(pen, box.x + pad, box.y + pad + pen->text_px, pen->scene->plant->name);
    pen_font(pen, 0.92, false);
    pen_ink(pen, 0.8);
    for (int i = 0; i < count; i++)
        pen_text(pen, box.x + pad, box.y + pad + (2.45 + 1.35 * i) * pen->text_px, lines[i]);
    pen_take(pen, &box);
}

/* Returns whether any sensor of the shown group has a reading that is not Bad. */
static bool is_live(const struct pen *pen)
{
    const struct plant *plant = pen->scene->plant;
    for (size_t i = 0; i < plant->tag_count && i < pen->snapshot->count; i++)
        if (is_shown(&pen->frame->view, plant->tags[i].group) && !quality_is_bad(pen->snapshot->readings[i].quality))
            return true;
    return false;
}

static void draw_banner(struct pen *pen, const char *text, const double rgb[3])
{
    pen_font(pen, 1.5, true);
    double width = pen_text_width(pen, text), pad = 12 * pen->unit;
    struct label_box box = { 0.5 * (pen->frame->width_px - width) - pad, 0, width + 2 * pad, 1.5 * pen->text_px + 1.4 * pad };
    box.y = pen->taken[0].y + pen->taken[0].height + pad;
    if (box.x > pen->taken[0].x + pen->taken[0].width + pad)
        box.y = pad;
    pen_rounded_path(pen, &box);
    cairo_set_source_rgb(pen->cairo, rgb[0], rgb[1], rgb[2]);
    cairo_fill(pen->cairo);
    cairo_set_source_rgb(pen->cairo, 1, 1, 1);
    pen_text(pen, box.x + pad, box.y + 0.7 * pad + 1.3 * pen->text_px, text);
    pen_take(pen, &box);
}

static const double NO_DATA_RGB[3] = { 0.66, 0.12, 0.10 }, PAST_RGB[3] = { 0.36, 0.18, 0.56 };

/* Draws a border around the frame and a banner, which mark a picture of the past. The border stays recognisable if a user crops the banner
   off the picture. */
static void draw_past(struct pen *pen)
{
    char text[CLOCK_BYTES + 80], clock[CLOCK_BYTES];
    bool live = is_live(pen);
    double width = fmax(2, 4 * pen->unit);
    format_clock(pen->frame->data_utc_ns, clock);
    snprintf(text, sizeof(text), "%s  ·  %s%s%s", pen_word(pen, WORD_HISTORY), clock, live ? "" : "  ·  ",
             live ? "" : pen_word(pen, WORD_NO_DATA_THEN));
    cairo_rectangle(pen->cairo, 0.5 * width, 0.5 * width, pen->frame->width_px - width, pen->frame->height_px - width);
    cairo_set_source_rgb(pen->cairo, PAST_RGB[0], PAST_RGB[1], PAST_RGB[2]);
    cairo_set_line_width(pen->cairo, width);
    cairo_stroke(pen->cairo);
    draw_banner(pen, text, PAST_RGB);
}

static void pen_init(struct pen *pen, cairo_surface_t *surface, const struct frame *frame, const struct scene *scene,
                     const struct snapshot *snapshot, const struct loop_checks *loop_checks)
{
    *pen = (struct pen){ .cairo = cairo_create(surface), .frame = frame, .scene = scene, .snapshot = snapshot, .loop_checks = loop_checks };
    double unit = fmin(frame->width_px / 1280.0, frame->height_px / 720.0);
    pen->unit = fmin(fmax(unit, 0.5), 8);
    pen->text_px = fmax(13 * pen->unit, 9.5);
}

/* Draws the overlay except header and banners: the legends, the list of alarms, and the markers. */
static void draw_rest(struct pen *pen)
{
    int halves = pen->frame->view.split ? 2 : 1;
    if (pen->frame->view.split)
        overlay_halves(pen);
    bool shared = pen->frame->view.split && overlay_legend_is_shared(pen);
    for (int half = shared ? 1 : 0; half < halves; half++) {
        pen_choose_half(pen, half);
        /* omits the legend of a half of the view that shows materials (LOOK_MATERIALS), because it shows no field values */
        if (pen->view.look != LOOK_MATERIALS)
            overlay_legend(pen);
    }
    if (!pen->bare)
        overlay_alarms(pen);
    for (int half = 0, cards = pen->taken_count; half < halves; half++) {
        pen_choose_half(pen, half);
        overlay_markers(pen, cards);
    }
}

static void draw(struct frame *frame, const struct scene *scene, const struct snapshot *snapshot, const struct loop_checks *loop_checks,
                 bool bare)
{
    cairo_surface_t *surface =
        cairo_image_surface_create_for_data(frame->bgrx, CAIRO_FORMAT_RGB24, frame->width_px, frame->height_px, frame->stride_bytes);
    struct pen *pen = mem_new(sizeof(*pen));
    pen_init(pen, surface, frame, scene, snapshot, loop_checks);
    pen->bare = bare;
    draw_header(pen);
    if (frame->view.at_us)
        draw_past(pen);
    else if (!is_live(pen))
        draw_banner(pen, pen_word(pen, WORD_NO_LIVE_DATA), NO_DATA_RGB);
    draw_rest(pen);
    cairo_surface_flush(surface);
    pen_choose_half(pen, 0);
    overlay_strip(pen, frame->bgrx, frame->stride_bytes);
    cairo_destroy(pen->cairo);
    cairo_surface_finish(surface);
    cairo_surface_destroy(surface);
    mem_free(pen);
}

void overlay_draw(struct frame *frame, const struct scene *scene, const struct snapshot *snapshot, const struct loop_checks *loop_checks)
{
    draw(frame, scene, snapshot, loop_checks, false);
}

void overlay_draw_bare(struct frame *frame, const struct scene *scene, const struct snapshot *snapshot,
                       const struct loop_checks *loop_checks)
{
    draw(frame, scene, snapshot, loop_checks, true);
}

static double legend_share(struct pen *pen, const struct view *view)
{
    double legend_px = 0, width_px = view->width_px;
    for (int half = 0; half < (view->split ? 2 : 1); half++) {
        pen_choose_half(pen, half);
        width_px = fmin(width_px, pen->area.width);
        if (pen->view.look != LOOK_MATERIALS)
            legend_px = fmax(legend_px, overlay_legend_width(pen));
    }
    return legend_px / width_px;
}

void overlay_window(const struct scene *scene, const struct view *view, struct camera_window *out)
{
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1);
    struct frame *frame = mem_new(sizeof(*frame));
    struct pen *pen = mem_new(sizeof(*pen));
    *frame = (struct frame){ .width_px = view->width_px, .height_px = view->height_px, .view = *view };
    pen_init(pen, surface, frame, scene, NULL, NULL);
    double header_px = header_height(pen, 2) + 8 * pen->unit;
    double strip_px = overlay_strip_height(frame);
    *out = (struct camera_window){ .left = -1,
                                   .right = 1 - 2 * legend_share(pen, view),
                                   .bottom = -1 + 2 * strip_px / view->height_px,
                                   .top = 1 - 2 * header_px / view->height_px };
    cairo_destroy(pen->cairo);
    cairo_surface_destroy(surface);
    mem_free(pen);
    mem_free(frame);
}
