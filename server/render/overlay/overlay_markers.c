/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws the sensor markers of a frame and their labels. */
#include <math.h>
#include <stdio.h>
#include <time.h>

#include "base/clock.h"
#include "base/mem.h"
#include "render/frame_record.h"
#include "render/overlay/crowd.h"
#include "render/overlay/overlay_pen.h"
#include "value/quality.h"

bool overlay_unproven(const struct pen *pen, int tag)
{
    if (pen->frame->record)
        return pen->frame->record->unproven[tag];
    return pen->loop_checks && loop_checks_unproven(pen->loop_checks, tag);
}

void overlay_outline(struct pen *pen, double x, double y, double radius, bool broken)
{
    double gap = 2 * M_PI * radius / 12;
    cairo_new_path(pen->cairo);
    cairo_arc(pen->cairo, x, y, radius, 0, 2 * M_PI);
    cairo_set_line_width(pen->cairo, fmax(1.2, 1.6 * pen->unit));
    if (broken)
        cairo_set_dash(pen->cairo, &gap, 1, 0);
    cairo_stroke(pen->cairo);
    cairo_set_dash(pen->cairo, NULL, 0, 0);
}

/* Draws a marker. Filled: visible. Hollow: behind a surface. Crossed: Bad. Dashed: unproven. Double circle: assumed position. */
static void draw_mark(struct pen *pen, const struct frame_marker *marker, bool bad)
{
    double radius = 4.2 * pen->unit, x = marker->x_px, y = marker->y_px;
    cairo_new_path(pen->cairo);
    cairo_arc(pen->cairo, x, y, radius, 0, 2 * M_PI);
    cairo_set_source_rgba(pen->cairo, 1, 1, 1, marker->occluded ? 0.35 : 0.95);
    cairo_fill(pen->cairo);
    pen_dark(pen, marker->occluded ? 0.7 : 1);
    overlay_outline(pen, x, y, radius, overlay_unproven(pen, marker->tag));
    if (pen->scene->plant->tags[marker->tag].place.assumed)
        /* draws a second, outer circle around the marker, because the position of the tag's sensor is only assumed */
        overlay_outline(pen, x, y, 1.75 * radius, false);
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

void overlay_ring(struct pen *pen, double x, double y, double radius, int priority, enum alarm_status word)
{
    static const double colors[ALARM_PRIORITIES][3] = {
        /* colours of alarm priorities, the same as on the page (clients/web/core/alarms.js); no colour map has similar colours */
        { 0xaf / 255.0, 0x0c / 255.0, 0x4a / 255.0 },
        { 0xff / 255.0, 0xff / 255.0, 0x96 / 255.0 },
        { 0xb6 / 255.0, 0x46 / 255.0, 0xaa / 255.0 },
        { 0x1e / 255.0, 0x00 / 255.0, 0xf5 / 255.0 },
    };
    const double *color = colors[priority - 1];
    double wide = word == ALARM_ACKNOWLEDGED ? 0.22 : 0.42;
    cairo_new_path(pen->cairo);
    cairo_arc(pen->cairo, x, y, radius, 0, 2 * M_PI);
    /* white rim around the dark rim of the alarm ring, so that the ring is visible on any colour */
    cairo_set_source_rgb(pen->cairo, 1, 1, 1);
    cairo_set_line_width(pen->cairo, fmax(4.6, (wide + 0.4) * radius));
    cairo_stroke_preserve(pen->cairo);
    pen_dark(pen, 1);
    cairo_set_line_width(pen->cairo, fmax(3.0, (wide + 0.19) * radius));
    cairo_stroke_preserve(pen->cairo);
    cairo_set_source_rgb(pen->cairo, color[0], color[1], color[2]);
    cairo_set_line_width(pen->cairo, fmax(1.8, wide * radius));
    cairo_stroke_preserve(pen->cairo);
    if (alarm_status_is_cleared(word)) {
        cairo_set_source_rgb(pen->cairo, 1, 1, 1);
        cairo_set_line_width(pen->cairo, fmax(1.0, 0.5 * wide * radius));
        cairo_stroke(pen->cairo);
    }
    cairo_new_path(pen->cairo);
}

static const struct reading *reading_of(const struct pen *pen, const struct frame_marker *marker)
{
    return &pen->snapshot->readings[marker->tag];
}

static bool has_alarm(const struct pen *pen, const struct frame_marker *marker)
{
    return reading_of(pen, marker)->alarm != ALARM_NONE;
}

static void draw_alarm(struct pen *pen, const struct frame_marker *marker)
{
    const struct reading *reading = reading_of(pen, marker);
    int priority = alarm_priority(&pen->scene->plant->tags[marker->tag], (enum alarm_kind)reading->alarm);
    overlay_ring(pen, marker->x_px, marker->y_px, 9.5 * pen->unit, priority, (enum alarm_status)reading->alarm_status);
}

/* Returns true if the view shows distances from a sensor and no distance is known on the marker's asset. For such a marker,
   only the alarm ring and its label are drawn. */
static bool is_elsewhere(const struct pen *pen, const struct frame_marker *marker)
{
    return pen->view.field.show == SHOW_DISTANCE && isnan(marker->value);
}

/* Formats the label of a tag whose reading is Bad: the alarm raised by the tag's last usable value, and the time of that value
   (with the date if that is not the date of the readings). */
static void format_bad(const struct pen *pen, const struct reading *reading, char out[64])
{
    enum alarm_kind alarm = (enum alarm_kind)reading->alarm;
    time_t seconds = (time_t)(reading->received_utc_ns / NS_PER_S), now = (time_t)(pen->snapshot->taken_utc_ns / NS_PER_S);
    struct tm local, today;
    char clock[16], since[48];
    if (alarm == ALARM_NONE || alarm == ALARM_BAD || !reading->received_utc_ns || !localtime_r(&seconds, &local) ||
        !localtime_r(&now, &today)) {
        snprintf(out, 64, "%s", pen_word(pen, WORD_BAD));
        return;
    }
    bool is_today = local.tm_yday == today.tm_yday && local.tm_year == today.tm_year;
    strftime(clock, sizeof(clock), is_today ? "%H:%M" : "%m-%d %H:%M", &local);
    pen_say(pen, WORD_HELD_SINCE, clock, NULL, since, sizeof(since));
    snprintf(out, 64, "%s %s", alarm_kind_name(alarm), since);
}

static void format_value(const struct pen *pen, const struct frame_marker *marker, char out[64])
{
    const struct plant_tag *tag = &pen->scene->plant->tags[marker->tag];
    const struct plant_group *group = &pen->scene->plant->groups[pen->view.field.group];
    const struct reading *reading = &pen->snapshot->readings[marker->tag];
    bool difference = pen->view.field.show == SHOW_DIFFERENCE, lost = quality_is_bad(reading->quality);
    const char *alarm = alarm_kind_name((enum alarm_kind)reading->alarm);
    int decimals = pen_decimals(group, marker->value);
    double value = pen_rounded(marker->value, decimals);
    if (is_elsewhere(pen, marker))
        snprintf(out, 64, "%s", alarm ? alarm : "");
    else if (pen->view.field.show == SHOW_DISTANCE)
        snprintf(out, 64, "%.2f m", marker->value);
    else if (quality_is_bad(marker->quality) && lost)
        format_bad(pen, reading, out);
    else if (quality_is_bad(marker->quality))
        snprintf(out, 64, "%s", pen_word(pen, WORD_UNKNOWN_THEN));
    else
        snprintf(out, 64, "%s%s%.*f %s%s%s%s", difference ? "Δ " : "", difference && value > 0 ? "+" : "", decimals, value,
                 tag->unit ? tag->unit : "", quality_is_uncertain(marker->quality) ? " ?" : "", alarm ? " " : "", alarm ? alarm : "");
}

struct label_text {
    char name[140], value[64];
    double name_width;
};

/* Draws a leader line from the rim of the marker, or of its ring, to the nearest point of the label. */
static void draw_leader(struct pen *pen, const struct label_item *item, const struct label_box *box)
{
    double x = fmax(box->x, fmin(box->x + box->width, item->x)), y = fmax(box->y, fmin(box->y + box->height, item->y));
    double away = fmax(hypot(x - item->x, y - item->y), 1e-6), rim = (item->ring ? 11 : 5) * pen->unit / away;
    if (rim >= 1)
        return;
    cairo_move_to(pen->cairo, item->x + (x - item->x) * rim, item->y + (y - item->y) * rim);
    cairo_line_to(pen->cairo, x, y);
    cairo_set_source_rgba(pen->cairo, 1, 1, 1, 0.85); /* light outline of the leader line, which makes it visible on dark ground */
    cairo_set_line_width(pen->cairo, fmax(2.5, 2.5 * pen->unit));
    cairo_stroke_preserve(pen->cairo);
    cairo_set_line_width(pen->cairo, fmax(1, pen->unit));
    pen_dark(pen, 1);
    cairo_stroke(pen->cairo);
}

static void draw_label(struct pen *pen, const struct label_box *box, const struct label_text *text)
{
    double pad = 4 * pen->unit;
    pen_card(pen, box);
    pen_font(pen, 0.85, false);
    pen_ink(pen, 0.85);
    pen_text(pen, box->x + pad, box->y + pad + 0.72 * pen->text_px, text->name);
    pen_font(pen, 0.85, true);
    pen_text(pen, box->x + pad + text->name_width, box->y + pad + 0.72 * pen->text_px, text->value);
}

/* Returns the depth of a tag's sensor along the view direction, in metres from the eye. */
static double depth_of(const struct pen *pen, int tag)
{
    const struct scene_asset *asset = &pen->scene->assets[pen->scene->plant->tags[tag].asset];
    const struct camera *camera = &pen->view.camera;
    double right[3], up[3], forward[3], depth_m = 0;
    camera_basis(camera, right, up, forward);
    for (size_t i = 0; i < asset->sensor_count; i++)
        for (int c = 0; c < 3 && asset->sensors[i].tag == tag; c++)
            depth_m += (asset->sensors[i].surface_m[c] - camera->eye_m[c]) * forward[c];
    return depth_m;
}

static bool is_bad(const struct frame_marker *marker)
{
    return quality_is_bad(marker->quality);
}

static bool is_inside(const struct pen *pen, const struct frame_marker *marker)
{
    const struct label_box *area = &pen->area;
    return marker->half == pen->half && marker->x_px >= area->x && marker->y_px >= 0 && marker->x_px < area->x + area->width &&
           marker->y_px < area->height;
}

/* The labels to be placed: one item for every visible marker outside all cards (boxes of the overlay, such as the legend). */
struct marker_labels {
    struct label_item *items;
    struct label_text *texts;
    int *tags;
    size_t count, bad;
    struct pen *pen;
};

static void add_wanted(struct pen *pen, const struct frame_marker *marker, struct marker_labels *wanted)
{
    const struct plant_tag *tag = &pen->scene->plant->tags[marker->tag];
    struct label_item *item = &wanted->items[wanted->count];
    struct label_text *text = &wanted->texts[wanted->count];
    wanted->tags[wanted->count++] = marker->tag;
    double pad = 4 * pen->unit;
    format_value(pen, marker, text->value);
    snprintf(text->name, sizeof(text->name), "%s  ", tag->name);
    pen_font(pen, 0.85, false);
    text->name_width = pen_text_width(pen, text->name);
    pen_font(pen, 0.85, true);
    *item = (struct label_item){ .x = (double)marker->x_px, .y = (double)marker->y_px, .held = LABEL_NONE, .callout = LABEL_NONE };
    item->width = text->name_width + pen_text_width(pen, text->value) + 2 * pad;
    item->height = 0.95 * pen->text_px + 2 * pad;
    item->depth_m = depth_of(pen, marker->tag);
    item->ring = has_alarm(pen, marker);
    item->asset = tag->asset;
    item->rank = item->ring                                                                        ? LABEL_BEYOND
                 : marker->occluded || is_elsewhere(pen, marker)                                   ? LABEL_NOT_WANTED
                 : is_bad(marker)                                                                  ? LABEL_BAD
                 : quality_is_uncertain(marker->quality) || tag->asset == pen->view.selected_asset ? LABEL_DOUBTFUL
                                                                                                   : LABEL_PLAIN;
    wanted->bad += item->rank == LABEL_BAD;
}

/* --- call-outs: one label for the alarms of several rings ---------------------------------------------------------------------- */

struct callout_text {
    char what[200], worst[200];
};

/* Writes a call-out's text: the asset with the most alarms if it has several, the number of other assets, and the number and
   worst kind of alarms. */
static void write_callout(const struct marker_labels *wanted, const int *members, size_t count, struct callout_text *text)
{
    const struct pen *pen = wanted->pen;
    const struct plant *plant = pen->scene->plant;
    const struct reading *readings = pen->snapshot->readings;
    int worst = -1, least = 0, most = -1, assets = 0;
    int *counts = mem_array(plant->asset_count, sizeof(*counts)); /* number of alarms by asset */
    for (size_t i = 0; i < count; i++) {
        int tag = wanted->tags[members[i]], word = (int)readings[tag].alarm_status;
        /* in a call-out, alarms that have returned to normal or are latched are less important than all others */
        bool gone = word == ALARM_RETURNED || word == ALARM_LATCHED;
        int grave = alarm_priority(&plant->tags[tag], (enum alarm_kind)readings[tag].alarm) + (gone ? ALARM_PRIORITIES : 0);
        if (worst < 0 || grave < least || (grave == least && tag < worst)) {
            worst = tag;
            least = grave;
        }
        if (plant->tags[tag].asset >= 0 && counts[plant->tags[tag].asset]++ == 0)
            assets++;
    }
    for (size_t i = 0; i < plant->asset_count; i++)
        if (counts[i] > 1 && (most < 0 || counts[i] > counts[most]))
            most = (int)i;
    mem_free(counts);
    const char *where = most >= 0 ? plant->assets[most].tag : "";
    char others[24] = "", number[24], alarms[60], grave[140];
    if (*where && assets > 1)
        snprintf(others, sizeof(others), " +%d", assets - 1);
    snprintf(number, sizeof(number), "%zu", count);
    pen_say(pen, WORD_ALARMS, number, NULL, alarms, sizeof(alarms));
    snprintf(text->what, sizeof(text->what), "%.110s%s%s%s", where, others, *where ? ", " : "", alarms);
    snprintf(grave, sizeof(grave), "%s %.120s", alarm_kind_name((enum alarm_kind)readings[worst].alarm), plant->tags[worst].name);
    pen_say(pen, WORD_WORST, grave, NULL, text->worst, sizeof(text->worst));
}

static const double LINE = 1.25; /* line height of call-outs (labels shared by several markers), as a multiple of the font size (text_px) */

static void measure_callout(void *arg, const int *members, size_t count, double size[2])
{
    const struct marker_labels *wanted = arg;
    struct pen *pen = wanted->pen;
    struct callout_text text;
    write_callout(wanted, members, count, &text);
    pen_font(pen, 0.85, true);
    size[0] = fmax(pen_text_width(pen, text.what), pen_text_width(pen, text.worst)) + 8 * pen->unit;
    size[1] = (0.95 + LINE) * pen->text_px + 8 * pen->unit;
}

/* Draws a call-out (one label for the alarms of several rings). lead: index of the call-out's first item. */
static void draw_callout(const struct marker_labels *wanted, const struct label_place *places, size_t lead)
{
    struct pen *pen = wanted->pen;
    const struct label_box *box = &places[lead].box;
    struct callout_text text;
    double pad = 4 * pen->unit;
    size_t count = 0;
    int *members = mem_array(wanted->count, sizeof(*members));
    for (size_t i = 0; i < wanted->count; i++)
        if (places[i].callout == (int)lead)
            members[count++] = (int)i;
    write_callout(wanted, members, count, &text);
    mem_free(members);
    pen_card(pen, box);
    pen_font(pen, 0.85, true);
    pen_ink(pen, 1);
    pen_text(pen, box->x + pad, box->y + pad + 0.72 * pen->text_px, text.what);
    pen_text(pen, box->x + pad, box->y + pad + (0.72 + LINE) * pen->text_px, text.worst);
}

static void place_labels(struct pen *pen, struct marker_labels *wanted, int cards)
{
    struct label_area area = { .box = pen->area,
                               .unit = pen->unit,
                               .blocked = pen->taken,
                               .blocked_count = (size_t)cards,
                               .measure = measure_callout,
                               .arg = wanted };
    struct label_place *places = mem_array(wanted->count, sizeof(*places));
    for (size_t i = 0; i < wanted->count; i++)
        if (wanted->bad > LABEL_MOST_BAD && wanted->items[i].rank == LABEL_BAD)
            wanted->items[i].rank = LABEL_NOT_WANTED;
    labels_place(wanted->items, wanted->count, &area, places);
    for (size_t i = 0; i < wanted->count; i++)
        if (labels_has_leader(wanted->items, places, wanted->count, pen->unit, i))
            draw_leader(pen, &wanted->items[i], &places[i].box);
    for (size_t i = 0; i < wanted->count; i++) {
        if (places[i].slot == LABEL_NONE || (places[i].callout != LABEL_NONE && places[i].callout != (int)i))
            continue;
        if (places[i].callout == (int)i)
            draw_callout(wanted, places, i);
        else
            draw_label(pen, &places[i].box, &wanted->texts[i]);
        pen_take(pen, &places[i].box);
    }
    mem_free(places);
}

static bool is_under(const struct pen *pen, int cards, const struct label_box *mark)
{
    for (int i = 0; i < cards; i++)
        if (box_meets(&pen->taken[i], mark))
            return true;
    return false;
}

/* Draws the values of isolines at those points of frame->labels where there is room. Labels of the same value keep a large distance from
   each other. */
static void label_isolines(struct pen *pen)
{
    const struct frame *frame = pen->frame;
    double least_px = 0.16 * pen->area.width, range = pen->view.range_max - pen->view.range_min, pad = 2 * pen->unit;
    bool *done = mem_array(frame->label_count, sizeof(*done));
    for (size_t i = 0; i < frame->label_count && !view_is_operator(&pen->view); i++) {
        const struct frame_label *label = &frame->labels[i];
        bool crowded = label->half != pen->half || label->arrow;
        for (size_t k = 0; k < i && !crowded; k++)
            crowded = done[k] && frame->labels[k].value == label->value &&
                      hypot(frame->labels[k].x_px - label->x_px, frame->labels[k].y_px - label->y_px) < least_px;
        char text[40];
        pen_number(label->value, pen->view.color_scale.log ? label->value : range, text);
        pen_font(pen, 0.75, true);
        double width = pen_text_width(pen, text) + 2 * pad, height = 0.75 * pen->text_px + 2 * pad;
        struct label_box box = { label->x_px - 0.5 * width, label->y_px - 0.5 * height, width, height };
        if (crowded || !pen_is_free(pen, &box))
            continue;
        done[i] = true;
        pen_take(pen, &box);
        cairo_rectangle(pen->cairo, box.x, box.y, box.width, box.height);
        cairo_set_source_rgba(pen->cairo, 1, 1, 1, 0.75);
        cairo_fill(pen->cairo);
        pen_dark(pen, 1);
        pen_text(pen, box.x + pad, box.y + pad + 0.66 * pen->text_px, text);
    }
    mem_free(done);
}

static struct label_box mark_box(const struct pen *pen, const struct frame_marker *marker)
{
    double radius = 5 * pen->unit;
    return (struct label_box){ (double)marker->x_px - radius, (double)marker->y_px - radius, 2 * radius, 2 * radius };
}

bool overlay_marker_seen(const struct pen *pen, const struct frame_marker *marker, const struct label_box *card)
{
    struct label_box mark = mark_box(pen, marker);
    return !marker->occluded && is_inside(pen, marker) && !is_under(pen, pen->taken_count, &mark) && !box_meets(card, &mark);
}

/* Returns whether the marker is drawn even where markers overlap: true if it has an alarm, is Bad or uncertain, is the chosen
   sensor, or belongs to the selected asset. */
static bool is_kept(const struct pen *pen, const struct frame_marker *marker)
{
    return has_alarm(pen, marker) || is_bad(marker) || quality_is_uncertain(marker->quality) ||
           (pen->view.field.show == SHOW_DISTANCE && pen->view.field.sensor == marker->tag) ||
           pen->scene->plant->tags[marker->tag].asset == pen->view.selected_asset;
}

/* Chooses the markers to draw. Markers under a card (a box of the overlay such as legend or header) are left out. Returns the number of
   markers; the caller frees the array of their indices. */
static size_t choose_markers(const struct pen *pen, int cards, size_t **chosen)
{
    const struct frame *frame = pen->frame;
    struct crowd_item *items = mem_array(frame->marker_count, sizeof(*items));
    bool *drawn = mem_array(frame->marker_count, sizeof(*drawn));
    size_t count = 0, kept = 0;
    *chosen = mem_array(frame->marker_count, sizeof(**chosen));
    for (size_t i = 0; i < frame->marker_count && !pen->bare; i++) {
        const struct frame_marker *marker = &frame->markers[i];
        struct label_box mark = mark_box(pen, marker);
        if (!is_inside(pen, marker) || is_under(pen, cards, &mark))
            continue;
        items[count] = (struct crowd_item){ .x = (double)marker->x_px, .y = (double)marker->y_px, .occluded = marker->occluded };
        items[count].depth_m = depth_of(pen, marker->tag);
        items[count].kept = is_kept(pen, marker);
        (*chosen)[count++] = i;
    }
    crowd_thin(items, count, pen->unit, drawn);
    for (size_t i = 0; i < count; i++)
        if (drawn[i])
            (*chosen)[kept++] = (*chosen)[i];
    mem_free(items);
    mem_free(drawn);
    return kept;
}

void overlay_markers(struct pen *pen, int cards)
{
    struct marker_labels wanted = { .pen = pen };
    size_t *chosen, count = choose_markers(pen, cards, &chosen);
    wanted.items = mem_array(count, sizeof(*wanted.items));
    wanted.texts = mem_array(count, sizeof(*wanted.texts));
    wanted.tags = mem_array(count, sizeof(*wanted.tags));
    overlay_arrows(pen);
    for (size_t i = 0; i < count; i++) {
        const struct frame_marker *marker = &pen->frame->markers[chosen[i]];
        struct label_box mark = mark_box(pen, marker);
        if (!marker->occluded)
            pen_take(pen, &mark);
        if (!marker->occluded || has_alarm(pen, marker))
            add_wanted(pen, marker, &wanted);
        if (has_alarm(pen, marker))
            draw_alarm(pen, marker);
        draw_mark(pen, marker, is_bad(marker));
    }
    place_labels(pen, &wanted, cards);
    label_isolines(pen);
    mem_free(chosen);
    mem_free(wanted.items);
    mem_free(wanted.texts);
    mem_free(wanted.tags);
}
