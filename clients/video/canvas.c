/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws the video's frames: a picture of the plant, or a text card that says why there is none, with a strip below. */
#include "canvas.h"

#include <math.h>

#include "brush.h"
#include "video_words.h"

static const double CARD_RGB[3] = { 0.10, 0.11, 0.13 }, ALARM_RGB[3] = { 0.66, 0.12, 0.10 }, STRIP_RGB[3] = { 0.13, 0.15, 0.18 };
static const double ASCENT = 1.07, HIGH = 1.36; /* ascent and height of a line of text, as multiples of the font size */

static int strip_px(int height_px)
{
    int strip = MAX(26, height_px / 24);
    return strip + strip % 2;
}

int canvas_picture_px(int height_px)
{
    return height_px - strip_px(height_px);
}

static void colour(cairo_t *cairo, const double rgb[3])
{
    cairo_set_source_rgb(cairo, rgb[0], rgb[1], rgb[2]);
}

/* Draws a line of text centred in `width` with its baseline at y, in font size px, or smaller if the line would not fit. */
static void centred(cairo_t *cairo, const char *text, double px, bool bold, double width, double y)
{
    double wide = brush_width(cairo, px, bold, text);
    px = wide > 0.92 * width ? px * 0.92 * width / wide : px;
    struct brush_box box = { 0, y - ASCENT * px, width, px };
    brush_text(cairo, &box, px, bold, BRUSH_CENTRE, text);
}

static char *time_text(const struct shown *look, gint64 utc_us, const char *format)
{
    GDateTime *utc = g_date_time_new_from_unix_utc(utc_us / G_USEC_PER_SEC);
    GDateTime *local = utc ? g_date_time_to_timezone(utc, look->zone) : NULL;
    char *text = local ? g_date_time_format(local, format) : NULL;
    g_clear_pointer(&local, g_date_time_unref);
    g_clear_pointer(&utc, g_date_time_unref);
    return text ? text : g_strdup("");
}

static void draw_card(cairo_t *cairo, const struct canvas *canvas, const struct shown *look, double height)
{
    double width = canvas->width_px, px = MIN(0.085 * height, 0.05 * width);
    colour(cairo, CARD_RGB);
    cairo_rectangle(cairo, 0, 0, width, height);
    cairo_fill(cairo);
    colour(cairo, ALARM_RGB);
    cairo_rectangle(cairo, 0, 0.5 * height - 2.1 * px, width, 1.9 * px);
    cairo_fill(cairo);
    centred(cairo, look->headline, px, true, width, 0.5 * height - 0.8 * px);
    if (look->since_us) {
        char *time = time_text(look, look->since_us, "%Y-%m-%d %H:%M:%S %Z"), *text = video_say(look->words, VIDEO_SINCE, time, NULL);
        centred(cairo, text, 0.8 * px, false, width, 0.5 * height + 1.0 * px);
        g_free(text);
        g_free(time);
    }
    centred(cairo, look->detail, 0.5 * px, false, width, 0.5 * height + 2.1 * px);
}

static char *age_text(const struct shown *look)
{
    if (!look->picture)
        return video_say(look->words, VIDEO_NO_PICTURE, NULL, NULL);
    if (look->age_ms < 0)
        return g_strdup("");
    double age_s = (double)look->age_ms / 1000;
    char number[32];
    g_snprintf(number, sizeof(number), "%.0f", ceil(age_s < 120 ? age_s : age_s / 60));
    return video_say(look->words, age_s < 120 ? VIDEO_AGE_S : VIDEO_AGE_MIN, number, NULL);
}

/* Draws the strip below the plant's picture: clock and age of the values on the right, always in full, and the title in the
   remaining room. */
static void draw_strip(cairo_t *cairo, const struct canvas *canvas, const struct shown *look, gint64 utc_us, double y)
{
    double height = canvas->height_px - y, px = 0.55 * height, pad = 0.5 * height;
    char *clock = time_text(look, utc_us, "%Y-%m-%d  %H:%M:%S"), *age = age_text(look);
    colour(cairo, look->picture ? STRIP_RGB : ALARM_RGB);
    cairo_rectangle(cairo, 0, y, canvas->width_px, height);
    cairo_fill(cairo);
    double clock_px = brush_width(cairo, px, true, clock), age_px = brush_width(cairo, px, false, age);
    struct brush_box box = { pad, y + 0.5 * (height - HIGH * px), canvas->width_px - 2 * pad, HIGH * px };
    brush_text(cairo, &box, px, true, BRUSH_RIGHT, clock);
    box.width -= clock_px + 1.5 * pad;
    if (age_px < box.width) {
        brush_text(cairo, &box, px, false, BRUSH_RIGHT, age);
        box.width -= age_px + pad;
    }
    if (box.width > 2 * px)
        brush_text(cairo, &box, px, false, BRUSH_LEFT, look->title);
    g_free(clock);
    g_free(age);
}

/* --- time code --------------------------------------------------------------------------------------------------------------- */

static guint64 code_of(const struct shown *look, gint64 utc_us)
{
    guint64 time = (guint64)(utc_us / (G_USEC_PER_SEC / 10)) & ((G_GUINT64_CONSTANT(1) << CANVAS_TIME_BITS) - 1);
    guint64 code = (G_GUINT64_CONSTANT(2) << CANVAS_TIME_BITS | time) << 1 | (look->picture ? 0 : 1);
    return code << 1 | (guint64)__builtin_parityll(code);
}

static void draw_code(cairo_t *cairo, const struct canvas *canvas, guint64 code)
{
    double wide = (double)canvas->width_px / CANVAS_CODE_BITS, high = 6;
    for (int i = 0; i < CANVAS_CODE_BITS; i++) {
        double white = code >> (CANVAS_CODE_BITS - 1 - i) & 1;
        cairo_set_source_rgb(cairo, white, white, white);
        cairo_rectangle(cairo, floor(i * wide), canvas->height_px - high, ceil(wide), high);
        cairo_fill(cairo);
    }
}

void canvas_draw(const struct canvas *canvas, guint8 *bgrx, int stride_bytes, const struct shown *look, gint64 utc_us)
{
    cairo_surface_t *surface =
        cairo_image_surface_create_for_data(bgrx, CAIRO_FORMAT_RGB24, canvas->width_px, canvas->height_px, stride_bytes);
    cairo_t *cairo = cairo_create(surface);
    double height = canvas_picture_px(canvas->height_px);
    if (look->picture) {
        cairo_set_source_surface(cairo, look->picture, 0, 0);
        cairo_paint(cairo);
    } else {
        draw_card(cairo, canvas, look, height);
    }
    draw_strip(cairo, canvas, look, utc_us, height);
    if (canvas->time_code)
        draw_code(cairo, canvas, code_of(look, utc_us));
    cairo_destroy(cairo);
    cairo_surface_destroy(surface);
}
