/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes markers as JSON. */
#include "message/marker_text.h"

#include <jansson.h>
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/json_text.h"
#include "base/text/text.h"
#include "message/json_values.h"
#include "value/quality.h"

enum { DIGITS = 7, ARROW_DIGITS = 5 };
static const float SAME_PX = 0.05f;

static json_t *tenths(double px)
{
    return number(round(px * 10) / 10);
}

static json_t *value_of(const struct frame *frame, const struct frame_marker *marker)
{
    const struct field_params *params = frame->view.split && marker->half ? &frame->view.right.field : &frame->view.field;
    bool lost = quality_is_bad(marker->quality) && params->show != SHOW_DISTANCE;
    return lost ? json_null() : reading_number(marker->value);
}

static int class_of(const struct frame_marker *marker)
{
    return quality_is_bad(marker->quality) ? 2 : quality_is_uncertain(marker->quality);
}

static bool is_placed(const struct frame_marker *marker)
{
    return isfinite(marker->x_px) && isfinite(marker->y_px);
}

static bool same_place(const struct frame_marker *a, const struct frame_marker *b)
{
    return a->tag == b->tag && a->half == b->half && a->occluded == b->occluded && fabsf(a->x_px - b->x_px) < SAME_PX &&
           fabsf(a->y_px - b->y_px) < SAME_PX;
}

static bool same_places(const struct frame *frame, const struct known_markers *known)
{
    if (!known->any || frame->marker_count != known->marker_count)
        return false;
    for (size_t i = 0; i < frame->marker_count; i++)
        if (!same_place(&frame->markers[i], &known->markers[i]))
            return false;
    return true;
}

/* Returns the first label in `labels`, from index *at on, that belongs to an arrow (arrow true) or to an isoline (false), and
   sets *at to the index after it; NULL: there is none. */
static const struct frame_label *next_label(const struct frame_label *labels, size_t count, size_t *at, bool arrow)
{
    while (*at < count && labels[*at].arrow != arrow)
        ++*at;
    return *at < count ? &labels[(*at)++] : NULL;
}

static bool same_labels(const struct frame *frame, const struct known_markers *known, bool arrow)
{
    size_t at = 0, known_at = 0;
    for (;;) {
        const struct frame_label *a = next_label(frame->labels, frame->label_count, &at, arrow);
        const struct frame_label *b = next_label(known->labels, known->label_count, &known_at, arrow);
        if (!a || !b)
            return !a && !b && (known->any || arrow);
        if (a->value != b->value || a->half != b->half || a->uncertain != b->uncertain || a->dx != b->dx || a->dy != b->dy ||
            a->stroke != b->stroke || !(fabsf(a->x_px - b->x_px) < SAME_PX) || !(fabsf(a->y_px - b->y_px) < SAME_PX))
            return false;
    }
}

static json_t *all_markers(const struct frame *frame)
{
    json_t *list = json_array();
    for (size_t i = 0; i < frame->marker_count; i++) {
        const struct frame_marker *m = &frame->markers[i];
        if (is_placed(m))
            json_array_append_new(list, json_pack("[i,o,o,i,i,o,i]", m->tag, tenths(m->x_px), tenths(m->y_px), m->occluded, m->half,
                                                  value_of(frame, m), class_of(m)));
    }
    return list;
}

/* Returns the values of the markers that have changed since they were last sent to the client, without positions. */
static json_t *changed_values(const struct frame *frame, const struct known_markers *known)
{
    json_t *list = json_array();
    for (size_t i = 0; i < frame->marker_count; i++) {
        const struct frame_marker *m = &frame->markers[i], *before = &known->markers[i];
        if (!is_placed(m) || (m->value == before->value && m->quality == before->quality))
            continue;
        json_t *row = json_pack("[i,i,o]", m->tag, m->half, value_of(frame, m));
        if (class_of(m) != 0)
            json_array_append_new(row, json_integer(class_of(m)));
        json_array_append_new(list, row);
    }
    return list;
}

static json_t *all_labels(const struct frame *frame)
{
    json_t *list = json_array();
    size_t at = 0;
    for (const struct frame_label *l; (l = next_label(frame->labels, frame->label_count, &at, false));)
        json_array_append_new(list, json_pack("[f,o,o,i]", l->value, tenths(l->x_px), tenths(l->y_px), l->half));
    return list;
}

static json_t *all_arrows(const struct frame *frame)
{
    json_t *list = json_array();
    size_t at = 0;
    for (const struct frame_label *l; (l = next_label(frame->labels, frame->label_count, &at, true));) {
        json_t *row = json_pack("[o,o,o,o,o,i,i]", tenths(l->x_px), tenths(l->y_px), number((double)l->dx), number((double)l->dy),
                                number(l->value), l->uncertain, l->half);
        if (l->stroke != 0)
            json_array_append_new(row, json_integer(l->stroke));
        json_array_append_new(list, row);
    }
    return list;
}

static void remember(struct known_markers *known, const struct frame *frame)
{
    mem_grow(&known->markers, &known->marker_capacity, frame->marker_count, sizeof(*known->markers));
    mem_grow(&known->labels, &known->label_capacity, frame->label_count, sizeof(*known->labels));
    if (frame->marker_count)
        memcpy(known->markers, frame->markers, frame->marker_count * sizeof(*known->markers));
    if (frame->label_count)
        memcpy(known->labels, frame->labels, frame->label_count * sizeof(*known->labels));
    known->marker_count = frame->marker_count;
    known->label_count = frame->label_count;
    memcpy(known->drawn_error, frame->drawn_error, sizeof(known->drawn_error));
    known->any = true;
}

void marker_text_cache_finish(struct marker_text_cache *lists)
{
    frame_unref(&lists->frame);
    mem_free(lists->markers);
    mem_free(lists->labels);
    mem_free(lists->arrows);
    *lists = (struct marker_text_cache){ 0 };
}

static void list_frame(struct marker_text_cache *lists, struct frame *frame)
{
    if (lists->frame == frame)
        return;
    marker_text_cache_finish(lists);
    lists->frame = frame_ref(frame);
}

static void add_list(struct text *text, const char *name, const char *list)
{
    text_add(text, ",\"%s\":", name);
    text_add_bytes(text, list, strlen(list));
}

/* Appends the JSON list of the frame's sensor markers: all with their positions or, if the client has the positions, only
   changed values. */
static void add_markers(struct text *text, struct frame *frame, const struct known_markers *known, struct marker_text_cache *lists)
{
    if (!same_places(frame, known)) {
        lists->markers = lists->markers ? lists->markers : json_text(all_markers(frame), READING_DIGITS);
        add_list(text, "markers", lists->markers);
        return;
    }
    char *values = json_text(changed_values(frame, known), READING_DIGITS);
    if (strcmp(values, "[]") != 0)
        add_list(text, "values", values);
    mem_free(values);
}

char *marker_text(struct frame *frame, uint32_t seq, struct known_markers *known, struct marker_text_cache *lists)
{
    struct text text = { 0 };
    list_frame(lists, frame);
    text_add(&text, "{\"type\":\"markers\",\"seq\":%u", seq);
    size_t head = text.length;
    add_markers(&text, frame, known, lists);
    if (!same_labels(frame, known, false)) {
        lists->labels = lists->labels ? lists->labels : json_text(all_labels(frame), DIGITS);
        add_list(&text, "isolines", lists->labels);
    }
    if (!same_labels(frame, known, true)) {
        lists->arrows = lists->arrows ? lists->arrows : json_text(all_arrows(frame), ARROW_DIGITS);
        add_list(&text, "arrows", lists->arrows);
    }
    if (frame->drawn_error[0] != known->drawn_error[0])
        text_add(&text, ",\"drawn_error\":%g", frame->drawn_error[0]);
    if (frame->drawn_error[1] != known->drawn_error[1])
        text_add(&text, ",\"drawn_error_right\":%g", frame->drawn_error[1]);
    remember(known, frame);
    if (text.length == head)
        text_finish(&text);
    else
        text_add(&text, "}");
    return text.at;
}

void known_markers_finish(struct known_markers *known)
{
    mem_free(known->markers);
    mem_free(known->labels);
    *known = (struct known_markers){ 0 };
}
