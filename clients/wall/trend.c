/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines of what was recorded, with limits where there is one tag, as in the page; hatched where there is no value. */
#include "player.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "base/mem.h"
#include "brush.h"
#include "value/quality.h"
#include "words.h"

enum { LINES = 6 };
static const int64_t FRESH_NS = 5 * NS_PER_S;
static const double LETTERS = 11; /* units */
static const uint32_t COLOURS[LINES] = { 0x0b5c93, 0xb34a00, 0x00734f, 0x8a3a73, 0x5b5b00, 0x4b4f56 }, LIMIT = 0x8a5a00, GRAVE = 0xa31515,
                      GAP = 0x8b949c;
/* clients/web/app/trends/trends.js: DASHES */
static const double DASHES[LINES][4] = { { 0 }, { 8, 4 }, { 2, 3 }, { 10, 3, 2, 3 }, { 5, 5 }, { 1, 4 } };
static const int DASH_COUNTS[LINES] = { 0, 2, 2, 4, 2, 2 };

struct axis_range { /* of tags with one unit */
    const char *unit;
    double low, high, step;
};

struct chart {
    const struct trend *trend;
    struct box box;
    double from_us, to_us, em;
    struct axis_range scales[LINES];
    size_t scale_count, line_count;
    size_t scale_of[LINES];
};

void trend_finish(struct trend *trend)
{
    json_decref(trend->answer);
    *trend = (struct trend){ 0 };
}

/* --- asking ------------------------------------------------------------------------------------------------------------------------- */

static size_t tag_count(const struct pane *pane)
{
    size_t count = json_array_size(pane->items);
    return count < LINES ? count : LINES;
}

void trend_ask(struct player *player, struct pane *pane, int64_t now_ns)
{
    struct text path = { 0 };
    if (now_ns < pane->trend.due_ns)
        return;
    for (int i = 0; i < player->pane_count; i++)
        if (player->panes[i].trend.asks) /* one at a time */
            return;
    text_add(&path, "/api/v1/history?points=%d&from=-%.0fs&to=now&tags=", (int)fmax(50, fmin(2000, pane->box.width / 2)),
             fmax(60, pane->trend.hours * 3600));
    bool any = false;
    for (size_t i = 0; i < tag_count(pane); i++) {
        const char *name = json_string_value(json_array_get(pane->items, i));
        if (!name || plant_find_tag(&player->model.plant, name) < 0)
            continue;
        text_add(&path, any ? "," : "%s", "");
        text_add_escaped(&path, name);
        any = true;
    }
    pane->trend.due_ns = now_ns + FRESH_NS;
    if (any) {
        pane->trend.asks = true;
        links_ask(&player->links, GET_HISTORY, path.at);
    }
    text_finish(&path);
}

void trend_take(struct player *player, const json_t *answer)
{
    for (int i = 0; i < player->pane_count; i++) {
        struct trend *trend = &player->panes[i].trend;
        if (!trend->asks)
            continue;
        trend->asks = false;
        trend->failed = !json_is_array(json_object_get(answer, "series"));
        trend->count++;
        json_decref(trend->answer); /* an old one would look like one of now */
        trend->answer = trend->failed ? NULL : json_deep_copy(answer);
    }
}

void trend_say(struct player *player, const struct pane *pane, int64_t now_ns, struct text *said)
{
    int tags[LINES];
    size_t count = tag_count(pane);
    if (pane->title)
        text_add(said, "%s", pane->title);
    for (size_t i = 0; i < count; i++) {
        const char *name = json_string_value(json_array_get(pane->items, i));
        tags[i] = name ? plant_find_tag(&player->model.plant, name) : -1;
        if (!pane->title)
            text_add(said, "%s%s", i ? ", " : "", name ? name : "?");
    }
    text_add(said, "\n%s\n%u %d", say("walls.age", "age", say_age(model_oldest_ns(&player->model, tags, count, -1, now_ns)), NULL),
             pane->trend.count, pane->trend.failed);
}

/* --- scales ------------------------------------------------------------------------------------------------------------------------- */

/* The distance between ticks of an axis of time, so that there are at most so many in so many seconds. */
static int time_step(double span_s, int most)
{
    static const int steps[] = { 1, 5, 10, 30, 60, 300, 600, 900, 1800, 3600, 7200, 14400, 21600, 43200, 86400 };
    for (size_t i = 0; i < sizeof(steps) / sizeof(steps[0]); i++)
        if (span_s / steps[i] <= most)
            return steps[i];
    return 86400 * (int)ceil(span_s / 86400 / most);
}

/* Widens a range so that it ends at ticks; their distance: 1, 2 or 5 times a power of ten. */
static double value_step(double *low, double *high, int most)
{
    double wide = fmax(*high - *low, 1e-9 * fmax(1, fabs(*high)));
    double step = pow(10, floor(log10(wide / most)));
    while (wide / step > most)
        step *= wide / (2 * step) <= most ? 2 : wide / (5 * step) <= most ? 5 : 10;
    *low = floor(*low / step) * step;
    *high = ceil(*high / step) * step;
    if (!(*high > *low))
        *high = *low + step;
    return step;
}

static uint32_t quality_of(const json_t *point, bool stretch)
{
    return (uint32_t)json_integer_value(json_array_get(point, stretch ? 7 : 2));
}

/* The values of a point: of one, or of the lowest and highest of a stretch. Returns false if it has none that is to be believed. */
static bool values_of(const json_t *point, bool stretch, double *low, double *high)
{
    const json_t *a = json_array_get(point, 1), *b = json_array_get(point, stretch ? 2 : 1);
    *low = json_number_value(a);
    *high = json_number_value(b);
    return json_is_number(a) && json_is_number(b) && (stretch || !quality_is_bad(quality_of(point, stretch)));
}

static bool is_stretch(const json_t *series)
{
    return json_integer_value(json_object_get(series, "bucket_us")) > 0;
}

static const json_t *series_of(const struct chart *chart, size_t line)
{
    return json_array_get(json_object_get(chart->trend->answer, "series"), line);
}

static void find_scales(struct chart *chart, int most)
{
    for (size_t i = 0; i < chart->line_count; i++) {
        const json_t *series = series_of(chart, i), *points = json_object_get(series, "points"), *point;
        const char *unit = json_string_value(json_object_get(series, "unit"));
        size_t at = 0, k;
        double low, high;
        while (at < chart->scale_count && strcmp(chart->scales[at].unit, unit ? unit : "") != 0)
            at++;
        if (at == chart->scale_count)
            chart->scales[chart->scale_count++] = (struct axis_range){ .unit = unit ? unit : "", .low = INFINITY, .high = -INFINITY };
        chart->scale_of[i] = at;
        struct axis_range *scale = &chart->scales[at];
        json_array_foreach((json_t *)points, k, point)
        {
            if (!values_of(point, is_stretch(series), &low, &high))
                continue;
            scale->low = fmin(scale->low, low);
            scale->high = fmax(scale->high, high);
        }
    }
    for (size_t i = 0; i < chart->scale_count; i++) {
        struct axis_range *scale = &chart->scales[i];
        if (!(scale->low <= scale->high)) /* no value at all */
            scale->low = 0, scale->high = 1;
        double margin = 0.04 * (scale->high - scale->low);
        scale->low -= margin;
        scale->high += margin;
        scale->step = value_step(&scale->low, &scale->high, most);
    }
}

static double x_of(const struct chart *chart, double us)
{
    double share = (us - chart->from_us) / (chart->to_us - chart->from_us);
    return chart->box.x + fmax(0, fmin(1, share)) * chart->box.width;
}

static double y_of(const struct chart *chart, const struct axis_range *scale, double value)
{
    return chart->box.y + chart->box.height * (1 - (value - scale->low) / (scale->high - scale->low));
}

/* --- drawing ------------------------------------------------------------------------------------------------------------------------ */

static void draw_axis_of_values(const struct chart *chart, cairo_t *cairo, const struct axis_range *scale, bool left)
{
    double em = chart->em, least = scale->step / 2;
    int decimals = (int)fmax(0, ceil(-log10(scale->step) - 1e-9)), last = (int)lround((scale->high - scale->low) / scale->step);
    for (int i = 0; i <= last; i++) {
        double value = scale->low + i * scale->step, y = y_of(chart, scale, value);
        if (left)
            brush_fill(cairo, &(struct box){ chart->box.x, round(y), chart->box.width, fmax(1, 0.06 * em) }, GROUND);
        struct box box = { chart->box.x - 5.3 * em, y - 0.68 * em, 5 * em, em };
        if (!left)
            box.x = chart->box.x + chart->box.width + 0.3 * em;
        brush_text(cairo, &box, em, false, INK_2, left ? ALIGN_RIGHT : ALIGN_LEFT, false,
                   say_number(fabs(value) < least ? 0 : value, decimals));
    }
}

static void draw_axis_of_time(const struct chart *chart, cairo_t *cairo)
{
    double em = chart->em, span_s = (chart->to_us - chart->from_us) / 1e6;
    int step = time_step(span_s, (int)fmax(1, chart->box.width / (5.5 * em)));
    time_t from = (time_t)(chart->from_us / 1e6);
    struct tm local;
    if (!localtime_r(&from, &local))
        return;
    long offset = local.tm_gmtoff;
    for (long at = ((from + offset) / step + 1) * step - offset; (double)at * 1e6 <= chart->to_us; at += step) {
        time_t then = at;
        char text[16];
        double x = x_of(chart, (double)at * 1e6);
        brush_fill(cairo, &(struct box){ round(x), chart->box.y, fmax(1, 0.06 * em), chart->box.height }, GROUND);
        if (localtime_r(&then, &local) && strftime(text, sizeof(text),
                                                   step < 60      ? "%H:%M:%S"
                                                   : step < 86400 ? "%H:%M"
                                                                  : "%m-%d",
                                                   &local) > 0)
            brush_text(cairo, &(struct box){ x - 3 * em, chart->box.y + chart->box.height + 0.2 * em, 6 * em, em }, em, false, INK_2,
                       ALIGN_CENTRE, false, text);
    }
}

/* Of the one tag that is shown, where they lie in the range. */
static void draw_limits(const struct player *player, const struct chart *chart, cairo_t *cairo, int tag)
{
    static const char *const names[LIMIT_COUNT] = { [LIMIT_LL] = "LL", [LIMIT_L] = "L", [LIMIT_H] = "H", [LIMIT_HH] = "HH" };
    const struct axis_range *scale = &chart->scales[0];
    double em = chart->em;
    for (int i = 0; i < LIMIT_COUNT; i++) {
        double limit = player->model.plant.tags[tag].limits[i];
        if (isnan(limit) || limit < scale->low || limit > scale->high)
            continue;
        uint32_t colour = i == LIMIT_LL || i == LIMIT_HH ? GRAVE : LIMIT;
        double y = y_of(chart, scale, limit);
        cairo_set_dash(cairo, (double[]){ 0.6 * em, 0.4 * em }, 2, 0);
        cairo_set_line_width(cairo, fmax(1, 0.1 * em));
        brush_colour(cairo, colour);
        cairo_move_to(cairo, chart->box.x, y);
        cairo_line_to(cairo, chart->box.x + chart->box.width, y);
        cairo_stroke(cairo);
        brush_text(cairo, &(struct box){ chart->box.x, y - 1.2 * em, chart->box.width - 0.3 * em, em }, 0.85 * em, true, colour,
                   ALIGN_RIGHT, false, names[i]);
    }
    cairo_set_dash(cairo, NULL, 0, 0);
}

/* --- where there is no value (clients/web/core/history.js: gaps) --------------------------------------------------------------------- */

struct gaps {
    const struct chart *chart;
    cairo_t *cairo;
    struct box row;
    uint32_t colour;
};

/* No value: hatched, as in the picture of the plant; uncertain: dots along the bottom. */
static void draw_gap(const struct gaps *gaps, double from_us, double to_us, uint32_t quality)
{
    double em = gaps->chart->em, left = x_of(gaps->chart, from_us), right = fmax(left + 0.2 * em, x_of(gaps->chart, to_us));
    double top = gaps->row.y, bottom = top + gaps->row.height, step = 0.7 * em, high = gaps->row.height;
    if (to_us <= from_us || !(quality_is_bad(quality) || quality_is_uncertain(quality)))
        return;
    cairo_save(gaps->cairo);
    cairo_set_source_rgba(gaps->cairo, (gaps->colour >> 16) / 255.0, (gaps->colour >> 8 & 255) / 255.0, (gaps->colour & 255) / 255.0,
                          quality_is_bad(quality) ? 0.45 : 1);
    if (quality_is_bad(quality)) {
        cairo_rectangle(gaps->cairo, left, top, right - left, high);
        cairo_clip(gaps->cairo);
        for (double x = floor((left - high) / step) * step; x < right; x += step) {
            cairo_move_to(gaps->cairo, x, bottom);
            cairo_line_to(gaps->cairo, x + high, top);
        }
        cairo_set_line_width(gaps->cairo, 0.12 * em);
        cairo_stroke(gaps->cairo);
    } else {
        for (double x = left; x < right; x += 0.6 * em)
            cairo_rectangle(gaps->cairo, x, bottom - 0.5 * em, 0.3 * em, 0.3 * em);
        cairo_fill(gaps->cairo);
    }
    cairo_restore(gaps->cairo);
}

/* Of several tags each in a row of its own. */
static void draw_gaps(const struct chart *chart, cairo_t *cairo, size_t line)
{
    const json_t *series = series_of(chart, line), *points = json_object_get(series, "points");
    bool stretch = is_stretch(series);
    size_t count = json_array_size(points);
    double length_us = (double)json_integer_value(json_object_get(series, "bucket_us"));
    double high = chart->box.height / (double)chart->line_count;
    struct gaps gaps = { chart, cairo, { chart->box.x, chart->box.y + (double)line * high, chart->box.width, high },
                         chart->line_count > 1 ? COLOURS[line] : GAP };
    double begin_us = count ? (double)json_integer_value(json_array_get(json_array_get(points, 0), 0)) : chart->to_us;
    draw_gap(&gaps, chart->from_us, begin_us, QUALITY_BAD);
    for (size_t i = 0; i < count; i++) {
        const json_t *point = json_array_get(points, i), *next = json_array_get(points, i + 1);
        double us = (double)json_integer_value(json_array_get(point, 0)), bad_us = json_number_value(json_array_get(point, 6));
        double next_us = next ? (double)json_integer_value(json_array_get(next, 0)) : chart->to_us;
        uint32_t quality = quality_of(point, stretch);
        if (!stretch && !json_is_number(json_array_get(point, 1)))
            quality = QUALITY_BAD;
        if (stretch && bad_us > 0 && !quality_is_bad(quality)) /* somewhere in it */
            draw_gap(&gaps, us, us + bad_us, QUALITY_BAD);
        draw_gap(&gaps, stretch && quality_is_bad(quality) ? fmax(us, us + length_us - bad_us) : us, next_us, quality);
    }
}

/* A point without a value ends the line; of a stretch, it goes through both ends of what it reached. */
static void draw_line(const struct chart *chart, cairo_t *cairo, size_t line)
{
    const json_t *series = series_of(chart, line), *points = json_object_get(series, "points"), *point;
    const struct axis_range *scale = &chart->scales[chart->scale_of[line]];
    bool stretch = is_stretch(series), step = json_is_true(json_object_get(series, "step")), drawn = false;
    double dashes[4], last_y = 0, half_us = 0.5 * (double)json_integer_value(json_object_get(series, "bucket_us"));
    size_t i;
    cairo_new_path(cairo);
    json_array_foreach((json_t *)points, i, point)
    {
        double low, high, x = x_of(chart, (double)json_integer_value(json_array_get(point, 0)) + half_us);
        bool known = values_of(point, stretch, &low, &high);
        if (drawn && (step || !known) && !stretch)
            cairo_line_to(cairo, x, last_y); /* it held until here */
        if (known) {
            (drawn ? cairo_line_to : cairo_move_to)(cairo, x, y_of(chart, scale, low));
            if (stretch)
                cairo_line_to(cairo, x, y_of(chart, scale, high));
            last_y = y_of(chart, scale, high);
        }
        drawn = known;
    }
    for (int k = 0; k < DASH_COUNTS[line]; k++)
        dashes[k] = DASHES[line][k] * 0.12 * chart->em;
    cairo_set_dash(cairo, dashes, DASH_COUNTS[line], 0);
    cairo_set_line_width(cairo, 0.16 * chart->em);
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
    brush_colour(cairo, COLOURS[line]);
    cairo_stroke(cairo);
    cairo_set_dash(cairo, NULL, 0, 0);
}

/* Each tag with its line, and what it says now. Returns how high it is. */
static double draw_names(const struct player *player, const struct chart *chart, cairo_t *cairo, const struct box *body)
{
    double em = chart->em, x = body->x + 0.7 * em, y = body->y + 0.3 * em;
    for (size_t i = 0; i < chart->line_count; i++) {
        const char *name = json_string_value(json_object_get(series_of(chart, i), "tag"));
        int tag = plant_find_tag(&player->model.plant, name ? name : "");
        const struct reading *now = tag >= 0 ? &player->model.snapshot->readings[tag] : NULL;
        double range = chart->scales[chart->scale_of[i]].high - chart->scales[chart->scale_of[i]].low;
        bool known = now && !quality_is_bad(now->quality);
        char text[200];
        snprintf(text, sizeof(text), "%s  %s %s", name ? name : "?",
                 known ? say_number(now->value, (int)fmax(0, fmin(6, 2 - floor(log10(range / 4))))) : say("quality.bad", NULL),
                 known ? chart->scales[chart->scale_of[i]].unit : "");
        double wide = brush_measure(cairo, em, true, text).width + 2.6 * em;
        if (x + wide > body->x + body->width - 0.7 * em && x > body->x + em) {
            x = body->x + 0.7 * em;
            y += 1.5 * em;
        }
        brush_fill(cairo, &(struct box){ x, y + 0.55 * em, 1.6 * em, 0.25 * em }, COLOURS[i]);
        brush_text(cairo, &(struct box){ x + 2 * em, y, wide, em }, em, true, INK, ALIGN_LEFT, false, text);
        x += wide + 0.8 * em;
    }
    return y + 1.6 * em - body->y;
}

void trend_draw(struct player *player, const struct pane *pane, cairo_t *cairo, const struct box *body)
{
    const struct trend *trend = &pane->trend;
    struct chart chart = { .trend = trend, .em = LETTERS * player->unit };
    double em = chart.em;
    if (!trend->answer) {
        brush_text(cairo, &(struct box){ body->x + em, body->y + 0.4 * body->height, body->width - 2 * em, body->height }, 1.2 * em, false,
                   INK_2, ALIGN_CENTRE, true, trend->failed ? say("trends.failed", "why", "/api/v1/history", NULL) : "\u2026");
        return;
    }
    chart.line_count = json_array_size(json_object_get(trend->answer, "series"));
    chart.line_count = chart.line_count < LINES ? chart.line_count : LINES;
    chart.from_us = (double)json_integer_value(json_object_get(trend->answer, "from_us"));
    chart.to_us = (double)json_integer_value(json_object_get(trend->answer, "to_us"));
    find_scales(&chart, (int)fmax(2, body->height / (3.2 * em)));
    brush_fill(cairo, body, RAISED);
    double names = draw_names(player, &chart, cairo, body), right = chart.scale_count > 1 ? 5.6 * em : 1.5 * em;
    chart.box =
        (struct box){ body->x + 5.6 * em, body->y + names + 0.6 * em, body->width - 5.6 * em - right, body->height - names - 2.6 * em };
    if (chart.box.width < 4 * em || chart.box.height < 2 * em || !(chart.to_us > chart.from_us))
        return;
    draw_axis_of_time(&chart, cairo);
    for (size_t i = 0; i < chart.scale_count && i < 2; i++)
        draw_axis_of_values(&chart, cairo, &chart.scales[i], i == 0);
    const char *name = json_string_value(json_object_get(series_of(&chart, 0), "tag"));
    int tag = plant_find_tag(&player->model.plant, name ? name : "");
    if (chart.line_count == 1 && tag >= 0)
        draw_limits(player, &chart, cairo, tag);
    cairo_save(cairo);
    cairo_rectangle(cairo, chart.box.x, chart.box.y, chart.box.width, chart.box.height);
    cairo_clip(cairo);
    for (size_t i = 0; i < chart.line_count; i++)
        draw_gaps(&chart, cairo, i);
    for (size_t i = 0; i < chart.line_count; i++)
        draw_line(&chart, cairo, i);
    cairo_restore(cairo);
}
