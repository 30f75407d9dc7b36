/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists the active alarms that no visible marker shows: those of hidden or off-screen sensors, of other groups, and of tags
   without a position. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "render/overlay/overlay_pen.h"
#include "value/quality.h"

enum { MAX_ROWS = 5 };
/* ROW: height of a row of the list, as a multiple of the font size (text_px). MAX_HEIGHT: maximum height of the list, as a
   fraction of the frame's height. */
static const double ROW = 1.5, MAX_HEIGHT = 0.3;

struct unseen {
    int tag, priority;
};

static int by_priority(const void *a, const void *b)
{
    const struct unseen *i = a, *k = b;
    return i->priority != k->priority ? (i->priority > k->priority) - (i->priority < k->priority) : (i->tag > k->tag) - (i->tag < k->tag);
}

/* The list of alarms, and its texts and card. */
struct alarm_list {
    struct unseen *alarms;
    size_t count, rows; /* number of alarms; number of alarms that are written, the most severe ones */
    char title[120];
    double pad;
    struct label_box card; /* height 0: not laid out yet */
};

/* Returns flags by tag: true if a visible marker shows the tag. Markers under `card` are not visible. The caller frees the array. */
static bool *find_seen(struct pen *pen, const struct label_box *card)
{
    bool *seen = mem_array(pen->scene->plant->tag_count, sizeof(*seen));
    for (int half = 0; half < (pen->frame->view.split ? 2 : 1); half++) {
        pen_choose_half(pen, half);
        for (size_t i = 0; i < pen->frame->marker_count; i++)
            if (overlay_marker_seen(pen, &pen->frame->markers[i], card))
                seen[pen->frame->markers[i].tag] = true;
    }
    return seen;
}

/* Adds the alarms that no visible marker shows to the list. listed: flags by tag, true if the list contains the tag's alarm. */
static void add_unseen(struct pen *pen, struct alarm_list *list, bool *listed)
{
    const struct plant *plant = pen->scene->plant;
    bool *seen = find_seen(pen, &list->card);
    for (size_t i = 0; i < plant->tag_count && i < pen->snapshot->count; i++) {
        enum alarm_kind alarm = (enum alarm_kind)pen->snapshot->readings[i].alarm;
        if (!alarm || seen[i] || listed[i])
            continue;
        listed[i] = true;
        list->alarms[list->count++] = (struct unseen){ (int)i, alarm_priority(&plant->tags[i], alarm) };
    }
    mem_free(seen);
    qsort(list->alarms, list->count, sizeof(*list->alarms), by_priority);
}

static void format_reading(const struct pen *pen, int tag, char out[200])
{
    const struct plant_tag *of = &pen->scene->plant->tags[tag];
    const struct reading *reading = &pen->snapshot->readings[tag];
    const struct plant_group *group = of->group >= 0 ? &pen->scene->plant->groups[of->group] : NULL;
    const char *kind = alarm_kind_name((enum alarm_kind)reading->alarm);
    int decimals = group ? pen_decimals(group, reading->value) : 2;
    if (quality_is_bad(reading->quality))
        snprintf(out, 200, "%.120s  %s  %s", of->name, pen_word(pen, WORD_BAD), kind);
    else
        snprintf(out, 200, "%.120s  %.*f %.20s  %s", of->name, decimals, pen_rounded(reading->value, decimals), of->unit ? of->unit : "",
                 kind);
}

static void lay_out(struct pen *pen, struct alarm_list *list)
{
    double pad = 8 * pen->unit, height_px = pen->frame->height_px - overlay_strip_height(pen->frame);
    double most_px = MAX_HEIGHT * height_px - 2 * pad;
    size_t rows = (size_t)fmin(fmin((double)list->count, MAX_ROWS), fmax(most_px / (ROW * pen->text_px) - 1, 0));
    char text[200], number[24];
    snprintf(number, sizeof(number), "%zu", list->count);
    pen_say(pen,
            rows < list->count && rows ? WORD_UNSEEN_SUCH_AS
            : list->count > 1          ? WORD_UNSEEN
                                       : WORD_UNSEEN_ONE,
            number, NULL, list->title, sizeof(list->title));
    pen_font(pen, 0.9, true);
    double width = pen_text_width(pen, list->title);
    pen_font(pen, 0.85, false);
    for (size_t i = 0; i < rows; i++) {
        format_reading(pen, list->alarms[i].tag, text);
        width = fmax(width, pen_text_width(pen, text) + 1.7 * pen->text_px);
    }
    list->rows = rows;
    list->pad = pad;
    list->card = (struct label_box){ pad, 0, width + 2 * pad, (1 + (double)rows) * ROW * pen->text_px + 1.5 * pad };
    list->card.y = height_px - pad - list->card.height;
}

static void draw_rows(struct pen *pen, const struct alarm_list *list)
{
    double x = list->card.x + list->pad, y = list->card.y + list->pad + ROW * pen->text_px;
    pen_font(pen, 0.85, false);
    for (size_t i = 0; i < list->rows; i++, y += ROW * pen->text_px) {
        const struct unseen *alarm = &list->alarms[i];
        char text[200];
        format_reading(pen, alarm->tag, text);
        overlay_ring(pen, x + 0.6 * pen->text_px, y + 0.65 * pen->text_px, 0.45 * pen->text_px, alarm->priority,
                     (enum alarm_status)pen->snapshot->readings[alarm->tag].alarm_status);
        pen_ink(pen, 1);
        pen_text(pen, x + 1.7 * pen->text_px, y + pen->text_px, text);
    }
}

static void draw_list(struct pen *pen, const struct alarm_list *list)
{
    pen_card(pen, &list->card);
    pen_take(pen, &list->card);
    pen_font(pen, 0.9, true);
    pen_ink(pen, 1);
    pen_text(pen, list->card.x + list->pad, list->card.y + list->pad + pen->text_px, list->title);
    draw_rows(pen, list);
}

void overlay_alarms(struct pen *pen)
{
    size_t tags = pen->scene->plant->tag_count, before;
    struct alarm_list list = { .alarms = mem_array(tags, sizeof(*list.alarms)) };
    bool *listed = mem_array(tags, sizeof(*listed));
    /* the card hides markers, whose alarms are then added to the list, which may enlarge the card. Alarms are never removed from the
       list, so the loop ends. */
    do {
        before = list.count;
        add_unseen(pen, &list, listed);
        if (list.count > before)
            lay_out(pen, &list);
    } while (list.count > before);
    if (list.count > 0)
        draw_list(pen, &list);
    mem_free(list.alarms);
    mem_free(listed);
}
