/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads tours from a daemon's JSON, and draws their texts into pictures. */
#include "tour.h"

#include <cairo.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "clients/cli/picture/saved_view.h"
#include "render/overlay/text_face.h"

json_t *tour_stops(const char *answer, const char *from, const char *id)
{
    json_t *all = json_loads(answer, 0, NULL), *tours = json_object_get(all, "tours"), *tour, *stops = NULL;
    struct text known = { 0 };
    size_t i;
    text_add(&known, "%s", "");
    json_array_foreach(tours, i, tour) {
        if (!strcmp(saved_view_text(tour, "id"), id))
            stops = json_incref(json_object_get(tour, "stops"));
        text_add(&known, "%s%s", i ? ", " : "", saved_view_text(tour, "id"));
    }
    if (!stops)
        fprintf(stderr, "plantcast: %s: this plant has no tour '%s' (tours: %s)\n", from, id, *known.at ? known.at : "none");
    text_finish(&known);
    json_decref(all);
    return stops;
}

double tour_dwell_s(const json_t *stop)
{
    return json_number_value(json_object_get(stop, "dwell_s"));
}

const char *tour_text(const json_t *stop)
{
    return saved_view_text(stop, "text");
}

bool tour_add_view(const json_t *stop, bool offline, struct snapshot_options *options)
{
    const char *id = saved_view_text(stop, "id");
    return offline ? saved_view_add_address(options, id, saved_view_text(stop, "view")) : snapshot_add_arg(options, "view", id);
}

static void write_instant(FILE *file, double s)
{
    int64_t ms = llround(s * 1000);
    fprintf(file, "%02lld:%02lld:%02lld.%03lld", (long long)(ms / 3600000), (long long)(ms / 60000 % 60), (long long)(ms / 1000 % 60),
            (long long)(ms % 1000));
}

/* Writes a text with `<` and `&` escaped for WebVTT. */
static void write_words(FILE *file, const char *text)
{
    for (; *text; text++)
        if (*text == '<' || *text == '&')
            fputs(*text == '<' ? "&lt;" : "&amp;", file);
        else
            fputc(*text, file);
}

bool tour_write_subtitles(const json_t *stops, const double *from_s, const char *film)
{
    const char *end = strrchr(film, '.');
    char *path = mem_printf("%.*s.vtt", end ? (int)(end - film) : (int)strlen(film), film);
    FILE *file = fopen(path, "w");
    const json_t *stop;
    size_t i;
    if (file)
        fputs("WEBVTT\n", file);
    json_array_foreach(stops, i, stop) {
        if (!file || !*tour_text(stop))
            continue;
        fputc('\n', file);
        write_instant(file, from_s[i]);
        fputs(" --> ", file);
        write_instant(file, from_s[i + 1]);
        fputc('\n', file);
        write_words(file, tour_text(stop));
        fputc('\n', file);
    }
    bool good = file && !ferror(file);
    good = file && fclose(file) == 0 && good;
    if (!good)
        fprintf(stderr, "plantcast: %s: %m\n", path);
    mem_free(path);
    return good;
}

/* --- text --------------------------------------------------------------------------------------------------------------------- */

enum { LINES = 6 };

static double width_of(cairo_t *cairo, const char *text)
{
    cairo_text_extents_t extents;
    cairo_text_extents(cairo, text, &extents);
    return extents.x_advance;
}

/* Breaks the text in place at blanks into lines of at most `room` pixels; `lines` receives the start of each line. Returns the
   number of lines. */
static int break_lines(cairo_t *cairo, char *text, double room, const char *lines[LINES])
{
    int count = 1;
    char *last = NULL;
    lines[0] = text;
    for (char *at = text;; at++) {
        char kept = *at;
        if (kept != ' ' && kept)
            continue;
        *at = 0;
        bool full = width_of(cairo, lines[count - 1]) > room;
        *at = kept;
        if (full && last && count < LINES) {
            *last = 0;
            lines[count++] = last + 1;
        }
        if (!kept)
            return count;
        last = at;
    }
}

void tour_draw_text(const char *text, uint8_t *bgrx, int width_px, int height_px, int stride_bytes)
{
    cairo_surface_t *surface = cairo_image_surface_create_for_data(bgrx, CAIRO_FORMAT_RGB24, width_px, height_px, stride_bytes);
    cairo_t *cairo = cairo_create(surface);
    double size = fmax(9, height_px / 36.0), pad = 0.6 * size, widest = 0;
    char *copy = mem_strdup(text);
    const char *lines[LINES];
    cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    text_face_choose(cairo, text);
    cairo_set_font_size(cairo, size);
    int count = break_lines(cairo, copy, 0.6 * width_px, lines);
    for (int i = 0; i < count; i++)
        widest = fmax(widest, width_of(cairo, lines[i]));
    double high = (1.3 * count) * size + 2 * pad, x = (width_px - widest) / 2, y = height_px - high - pad;
    cairo_rectangle(cairo, x - pad, y, widest + 2 * pad, high);
    cairo_set_source_rgba(cairo, 1, 1, 1, 0.88);
    cairo_fill(cairo);
    cairo_set_source_rgb(cairo, 0.10, 0.13, 0.17);
    for (int i = 0; i < count; i++) {
        cairo_move_to(cairo, x, y + pad + (1.3 * i + 1) * size);
        cairo_show_text(cairo, lines[i]);
    }
    mem_free(copy);
    cairo_destroy(cairo);
    cairo_surface_destroy(surface);
}
