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

/* Returns flags by tag: true if a visible marker shows the tag. The caller frees the array. */
static bool *find_seen(struct pen *pen)
{
    bool *seen = mem_array(pen->scene->plant->tag_count, sizeof(*seen));
    for (int half = 0; half < (pen->frame->view.split ? 2 : 1); half++) {
        pen_choose_half(pen, half);
        for (size_t i = 0; i < pen->frame->marker_count; i++)
            if (overlay_marker_seen(pen, &pen->frame->markers[i]))
                seen[pen->frame->markers[i].tag] = true;
    }
    return seen;
}

/* Writes the alarms that no visible marker shows to `list`, which has room for every tag. Returns the count. */
static size_t find_unseen(struct pen *pen, struct unseen *list)
{
    const struct plant *plant = pen->scene->plant;
    bool *seen = find_seen(pen);
    size_t count = 0;
    for (size_t i = 0; i < plant->tag_count && i < pen->snapshot->count; i++) {
        enum alarm_kind alarm = (enum alarm_kind)pen->snapshot->readings[i].alarm;
        if (alarm && !seen[i])
            list[count++] = (struct unseen){ (int)i, alarm_priority(&plant->tags[i], alarm) };
    }
    mem_free(seen);
    qsort(list, count, sizeof(*list), by_priority);
    return count;
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

static void draw_rows(struct pen *pen, const struct label_box *card, double pad, const struct unseen *list, size_t rows)
{
    double y = card->y + pad + ROW * pen->text_px;
    pen_font(pen, 0.85, false);
    for (size_t i = 0; i < rows; i++, y += ROW * pen->text_px) {
        const struct reading *reading = &pen->snapshot->readings[list[i].tag];
        char text[200];
        format_reading(pen, list[i].tag, text);
        overlay_ring(pen, card->x + pad + 0.6 * pen->text_px, y + 0.65 * pen->text_px, 0.45 * pen->text_px, list[i].priority,
                     (enum alarm_status)reading->alarm_status);
        pen_ink(pen, 1);
        pen_text(pen, card->x + pad + 1.7 * pen->text_px, y + pen->text_px, text);
    }
}

static void draw_list(struct pen *pen, const struct unseen *list, size_t count)
{
    double pad = 8 * pen->unit, most_px = MAX_HEIGHT * pen->frame->height_px - 2 * pad;
    size_t rows = (size_t)fmin(fmin((double)count, MAX_ROWS), fmax(most_px / (ROW * pen->text_px) - 1, 0));
    char title[120], text[200], number[24];
    snprintf(number, sizeof(number), "%zu", count);
    pen_say(pen,
            rows < count && rows ? WORD_UNSEEN_SUCH_AS
            : count > 1          ? WORD_UNSEEN
                                 : WORD_UNSEEN_ONE,
            number, NULL, title, sizeof(title));
    pen_font(pen, 0.9, true);
    double width = pen_text_width(pen, title);
    pen_font(pen, 0.85, false);
    for (size_t i = 0; i < rows; i++) {
        format_reading(pen, list[i].tag, text);
        width = fmax(width, pen_text_width(pen, text) + 1.7 * pen->text_px);
    }
    struct label_box card = { pad, 0, width + 2 * pad, (1 + (double)rows) * ROW * pen->text_px + 1.5 * pad };
    card.y = pen->frame->height_px - pad - card.height;
    pen_card(pen, &card);
    pen_take(pen, &card);
    pen_font(pen, 0.9, true);
    pen_ink(pen, 1);
    pen_text(pen, card.x + pad, card.y + pad + pen->text_px, title);
    draw_rows(pen, &card, pad, list, rows);
}

void overlay_alarms(struct pen *pen)
{
    struct unseen *list = mem_array(pen->scene->plant->tag_count, sizeof(*list));
    size_t count = find_unseen(pen, list);
    if (count)
        draw_list(pen, list, count);
    mem_free(list);
}
