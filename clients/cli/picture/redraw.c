/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Redraws a signed picture and compares the result with the picture. The picture's file contains a statement: a signed JSON
   text with plant, time, view and all readings, from which the offline renderer draws. */
#include "redraw.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "offline_renderer.h"
#include "render/overlay/overlay.h"
#include "value/quality.h"

/* Copies the arguments of the snapshot query in the picture's signed statement to *options, except `at`: a relative `at=-8h`
   would mean another instant today, and the statement also has the absolute instant. Returns false if one is invalid. */
static bool take_query(const json_t *statement, struct snapshot_options *options)
{
    const json_t *args = json_object_get(statement, "query");
    for (size_t i = 0; i < json_array_size(args); i++) {
        const char *arg = json_string_value(json_array_get(args, i));
        char *name = strndup(arg, strcspn(arg, "="));
        bool good = !strcmp(name, "at") || snapshot_add_arg(options, name, arg + strlen(name) + (arg[strlen(name)] == '='));
        free(name);
        if (!good)
            return false;
    }
    return true;
}

static bool same_configuration(const json_t *statement, const struct plant *plant)
{
    const char *then = json_string_value(json_object_get(statement, "configuration"));
    if (then && !strcmp(then, plant->files.hash))
        return true;
    printf("  DIFFERS: the configuration hash of %s was %s when the picture was drawn, now %s\n", plant->files.path, then ? then : "?",
           plant->files.hash);
    return false;
}

static bool same_assets(const json_t *statement, const struct scene *scene)
{
    const json_t *assets = json_object_get(statement, "assets");
    size_t others = 0;
    for (size_t i = 0; i < scene->asset_count; i++) {
        char checksum[PICTURE_CHECKSUM_BYTES];
        const char *then = json_string_value(json_object_get(assets, scene->plant->assets[i].id));
        picture_asset_checksum(&scene->assets[i], checksum);
        if (strcmp(then ? then : "", checksum) != 0 && others++ == 0)
            printf("  DIFFERS: checksum of the prepared file of asset %s: %s when the picture was drawn, now %s\n",
                   scene->plant->assets[i].id, then ? then : "missing", *checksum ? checksum : "missing");
    }
    if (others > 1)
        printf("  DIFFERS: the checksums of the prepared files of %zu more assets have changed since the picture was drawn\n", others - 1);
    return others == 0;
}

/* Returns true if two readings have equal quality and value. The values of bad readings are not compared. */
static bool same_reading(const struct reading *a, const struct reading *b)
{
    bool usable = !quality_is_bad(a->quality);
    return a->quality == b->quality && (!usable || (float)a->value == (float)b->value);
}

/* Compares the readings in the signed statement with those recorded in the history folder at the picture's instant, and prints
   how many agree. at_us: that instant if the picture shows the past, microseconds UTC; 0: a live picture, whose instant is that
   of its readings. Returns true if all agree. */
static bool same_as_recorded(struct offline_renderer *offline, const struct redraw_options *options, const struct frame_record *record,
                             int64_t at_us)
{
    struct snapshot_options where = { .history = options->history };
    int64_t us = at_us ? at_us : record->readings->taken_utc_ns / 1000;
    size_t same = 0, count = offline->plant->tag_count, first = 0;
    if (!offline_renderer_open_history(offline, &where))
        return false;
    if (us < offline->first_us || us > offline->last_us) {
        printf("  NOT CHECKED: history folder %s has no readings from the picture's time\n", options->history);
        return false;
    }
    struct snapshot *then = snapshot_create(offline->plant->tag_count);
    bool good = history_at(offline->reader, offline->tags, us, then) == 0;
    for (size_t i = 0; i < count && good; i++) {
        bool equal = same_reading(&record->readings->readings[i], &then->readings[i]);
        same += equal;
        if (!equal && first == 0)
            first = i + 1;
    }
    snapshot_destroy(&then);
    printf("  %s%zu of %zu readings in the picture agree with the recorded history\n", same == count ? "" : "DIFFERS: ", same, count);
    if (first)
        printf("  first reading in the picture that differs from the recorded history: tag %s\n", offline->plant->tags[first - 1].name);
    return same == count;
}

/* Returns the number of pixels in which no colour channel differs by more than 1 (of 255). */
static size_t count_agreeing(const struct frame *frame, const uint8_t *rgb)
{
    size_t agreeing = 0;
    for (int y = 0; y < frame->height_px; y++) {
        const uint8_t *ours = frame->bgrx + (size_t)y * (size_t)frame->stride_bytes;
        for (int x = 0; x < frame->width_px; x++, ours += 4, rgb += 3)
            agreeing += abs(ours[2] - rgb[0]) <= 1 && abs(ours[1] - rgb[1]) <= 1 && abs(ours[0] - rgb[2]) <= 1;
    }
    return agreeing;
}

/* Compares the redrawn frame with the signed picture. rgb: the signed picture's pixels, in the width and height given in the statement. */
static bool same_pixels(const struct frame *frame, const json_t *statement, const uint8_t *rgb)
{
    size_t all = (size_t)frame->width_px * (size_t)frame->height_px;
    bool fits = json_integer_value(json_object_get(statement, "width")) == frame->width_px &&
                json_integer_value(json_object_get(statement, "height")) == frame->height_px;
    size_t agreeing = fits ? count_agreeing(frame, rgb) : 0;
    printf("  %s%zu of %zu pixels of the picture agree with the redrawn picture within 1/255\n",
           agreeing == all ? "" : "DIFFERS: ", agreeing, all);
    return agreeing == all;
}

static struct frame *draw(struct offline_renderer *offline, const json_t *statement, struct frame_record *record, struct view *view)
{
    view_set_instant(view, json_integer_value(json_object_get(statement, "at_us")), 0);
    const char *tier = json_string_value(json_object_get(statement, "tier"));
    const char *overlay = json_string_value(json_object_get(statement, "overlay"));
    view->tier = tier && !strcmp(tier, "preview") ? TIER_PREVIEW : TIER_REFINED;
    struct frame *frame = split_view_draw_now(offline->renderer, view, record->readings);
    if (!frame)
        return NULL;
    frame_read_markers(frame, record->readings, offline->baselines);
    frame->clock_unset = json_is_true(json_object_get(statement, "clock_unset"));
    frame->record = frame_record_ref(record);
    if (!overlay || strcmp(overlay, "none") != 0)
        overlay_draw(frame, offline->scene, record->readings, NULL);
    return frame;
}

static int compare(struct offline_renderer *offline, const struct redraw_options *options, const json_t *statement,
                   struct frame_record *record, const struct frame *frame, const uint8_t *rgb)
{
    bool same = same_configuration(statement, offline->plant);
    same = same_assets(statement, offline->scene) && same;
    same = same_pixels(frame, statement, rgb) && same;
    if (options->history)
        same = same_as_recorded(offline, options, record, json_integer_value(json_object_get(statement, "at_us"))) && same;
    return same ? 0 : 1;
}

int redraw_compare(const struct redraw_options *options, const json_t *statement, const uint8_t *rgb)
{
    struct snapshot_options snapshot = { .from = options->plant, .prepared = options->prepared, .gl = GL_AUTO };
    char why[SIGNED_PICTURE_WHY_BYTES];
    struct offline_renderer offline;
    struct frame_record *record = NULL;
    struct frame *frame = NULL;
    struct view view;
    bool good = offline_renderer_open_plant(&offline, &snapshot);
    if (good && !(record = signed_picture_record(statement, offline.plant, offline.baselines, why)))
        fprintf(stderr, "plantcast: %s\n", why);
    if (record && take_query(statement, &snapshot) && offline_renderer_take_view(&offline, &snapshot, &view) &&
        offline_renderer_open_gl(&offline, &snapshot))
        frame = draw(&offline, statement, record, &view);
    int code = frame ? compare(&offline, options, statement, record, frame, rgb) : 2;
    frame_unref(&frame);
    frame_record_unref(&record);
    offline_renderer_close(&offline);
    snapshot_options_finish(&snapshot);
    return code;
}
