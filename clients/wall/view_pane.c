/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures of the plant, as a session of the server sends them. */
#include "view_pane.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "message/message.h"
#include "render/overlay/overlay.h"
#include "scene/framing.h"
#include "value/quality.h"
#include "view_address.h"
#include "words.h"

void view_pane_init(struct view_pane *pane, struct link *link, int width_px, int height_px, double unit, bool by_gpu)
{
    view_pane_clear(pane);
    pane->link = link;
    pane->width_px = width_px;
    pane->height_px = height_px;
    pane->unit = unit;
    pane->by_gpu = by_gpu;
}

static void forget_markers(struct view_pane *pane)
{
    mem_free(pane->frame.markers);
    mem_free(pane->frame.labels);
    pane->frame = (struct frame){ .oldest_age_ns = INT64_MAX };
}

static void drop_picture(struct view_pane *pane)
{
    if (pane->picture)
        cairo_surface_destroy(pane->picture);
    mem_free(pane->pixels);
    pane->picture = NULL;
    pane->pixels = NULL;
}

void view_pane_clear(struct view_pane *pane)
{
    drop_picture(pane);
    pane->is_current = pane->greeted = false;
    view_sight_end(&pane->sight);
    pane->coming_count = 0;
    json_decref(pane->coming_markers);
    pane->coming_markers = NULL;
    view_tile_clear(&pane->tile);
    forget_markers(pane);
}

void view_pane_finish(struct view_pane *pane)
{
    view_pane_clear(pane);
    view_sight_finish(&pane->sight);
    json_decref(pane->start);
    decoder_destroy(&pane->decoder);
    mem_free(pane->canvas);
    *pane = (struct view_pane){ 0 };
}

/* --- what is asked for ------------------------------------------------------------------------------------------------------------ */

json_t *view_pane_hello(const struct view_pane *pane)
{
    char why[DECODER_WHY_BYTES];
    json_t *codecs = decoder_has(WIRE_CODEC_H264, why) ? json_pack("[s,s,s]", "h264", "jpeg", "auto") : json_pack("[s]", "jpeg");
    json_t *hello = json_pack("{s:s,s:i,s:i,s:f,s:o}", "type", "hello", "width", pane->width_px, "height", pane->height_px, "pixel_ratio",
                              fmin(fmax(pane->unit, 0.25), 8), "codecs", codecs);
    if (pane->tile.display)
        json_object_set_new(hello, "tile", json_pack("{s:s,s:i}", "wall", pane->tile.wall, "display", pane->tile.display));
    return hello;
}

/* The server's own reader does it; what is of one server alone, or needs the geometry, is set apart. */
static bool read_view(const struct model *model, const json_t *params, int width_px, int height_px, struct view *view)
{
    static const char *const others[] = { "sensors", "sensor", "baseline", "baselines", "unit", "split" };
    const struct params_context context = { .scene = &model->scene };
    const char *show = json_string_value(json_object_get(params, "show")), *sensor = json_string_value(json_object_get(params, "sensor"));
    const json_t *split = json_object_get(params, "split");
    struct params_change change;
    struct message_error error;
    json_t *plain = json_copy((json_t *)params);
    bool is_distance = show && !strcmp(show, "distance"), is_difference = show && !strcmp(show, "difference");
    for (size_t i = 0; i < sizeof(others) / sizeof(others[0]); i++)
        json_object_del(plain, others[i]);
    if (is_distance || is_difference)
        json_object_del(plain, "show");
    view_default(&model->scene, width_px, height_px, view);
    view->language = words_language();
    bool good = params_parse(&model->plant, plain, &change, &error) && params_apply(&context, &change, view, &error);
    json_decref(plain);
    int tag = good && is_distance && sensor ? plant_find_tag(&model->plant, sensor) : -1;
    if (good && (is_difference || tag >= 0))
        view->field.show = is_difference ? SHOW_DIFFERENCE : SHOW_DISTANCE;
    view->field.sensor = tag;
    struct view right;
    if (good && json_is_object(split) && read_view(model, split, width_px, height_px, &right))
        view_split(view, &right);
    if (!good)
        fprintf(stderr, "plantcast-wall: parameters that this player does not know: %s\n", error.text);
    return good;
}

static void copy_names(json_t *to, const json_t *from, const char *const *names)
{
    for (; *names; names++)
        if (json_object_get(from, *names))
            json_object_set(to, *names, json_object_get(from, *names));
}

/* What a view has where its address says nothing. */
static json_t *plain_params(const struct view_pane *pane, const struct model *model, const char *group)
{
    static const char *const started[] = { "group",    "show",   "colormap", "look",  "light", "environment",
                                           "backdrop", "hidden", "isolate",  "ghost", NULL };
    static const char *const owned[] = { "interpolation", "distance", "scale", "isolines", NULL };
    static const char *const engineers[] = { "fill", "power", "radius_m", "reach_m", NULL };
    const json_t *groups = json_object_get(model->welcome, "groups");
    json_t *params = json_object();
    copy_names(params, pane->start, started);
    json_object_update_new(params,
                           json_pack("{s:n,s:i,s:n,s:n,s:n,s:n}", "range", "ramp_interval", 0, "breaks", "split", "selected", "clip"));
    int index = group ? plant_find_group(&model->plant, group) : -1;
    if (index < 0)
        index = plant_find_group(&model->plant, json_string_value(json_object_get(params, "group")));
    const json_t *own = json_array_get(groups, index < 0 ? 0 : (size_t)index);
    json_object_set(params, "group", json_object_get(own, "id"));
    copy_names(params, own, owned);
    if (json_array_size(json_object_get(own, "breaks")) > 0)
        json_object_set_new(params, "breaks", json_string("group"));
    if (pane->engineer) {
        copy_names(params, own, engineers);
        json_object_update_new(params, json_pack("{s:i,s:i,s:n}", "strength", 1, "decay", 1, "sensors"));
    }
    return params;
}

/* Of its camera; behind the eye: false. */
static bool project(const struct camera *camera, double width_px, double height_px, const double point_m[3], double *x, double *y)
{
    double right[3], up[3], forward[3], at[3] = { 0, 0, 0 };
    camera_basis(camera, right, up, forward);
    for (int i = 0; i < 3; i++) {
        double from_m = point_m[i] - camera->eye_m[i];
        at[0] += from_m * right[i];
        at[1] += from_m * up[i];
        at[2] += from_m * forward[i];
    }
    double high_m = camera->height_m > 0 ? camera->height_m : 2 * at[2] * tan(camera->fov_deg * M_PI / 360);
    if (!(high_m > 0))
        return false;
    *x = 0.5 * width_px + at[0] / high_m * height_px;
    *y = 0.5 * height_px - at[1] / high_m * height_px;
    return true;
}

/* From home, or of a tag: -1. The legend hides nothing of it. */
static struct camera find_camera(const struct view_pane *pane, const struct model *model, const json_t *params, int tag)
{
    const struct plant_view *home = &model->plant.view;
    struct camera camera = { .up = { 0, model->plant.up == AXIS_Y, model->plant.up == AXIS_Z }, .fov_deg = home->fov_deg };
    struct framing framing = { .asset = -1, .tag = tag, .side = SIDE_NOW };
    double aspect = (double)pane->width_px / pane->height_px;
    if (pane->tile.display) /* all of the picture */
        aspect *= (double)pane->tile.columns / pane->tile.rows;
    struct view view;
    memcpy(camera.eye_m, home->eye_m, sizeof(camera.eye_m));
    memcpy(camera.target_m, home->target_m, sizeof(camera.target_m));
    if (read_view(model, params, pane->width_px, pane->height_px, &view)) {
        overlay_pane_window(&model->scene, &view, pane->unit, &framing.window);
        aspect /= view.split ? 2 : 1; /* of each half */
    }
    if (framing.window.right < 0) /* a pane that is hardly wider than its legend */
        framing.window = (struct camera_window){ 0 };
    if (tag < 0 && home->set)
        framing_keep(&model->scene, aspect, &framing.window, &camera);
    else
        framing_look(&model->scene, &framing, aspect, &camera);
    return camera;
}

static void post_camera(struct view_pane *pane, json_t *camera)
{
    json_object_update_new(camera, json_pack("{s:s,s:I}", "type", "camera", "seq", (json_int_t)++pane->camera_seq));
    pane->is_current = false;
    link_post(pane->link, camera);
}

static void ask(struct view_pane *pane, json_t *params, json_t *camera)
{
    json_object_update_new(params, json_pack("{s:s,s:I}", "type", "params", "seq", (json_int_t)++pane->params_seq));
    pane->view_seq = pane->params_seq;
    pane->refused[0] = 0;
    view_sight_end(&pane->sight);
    link_post(pane->link, params);
    post_camera(pane, camera);
}

/* Equipment that is not shown is shown from now on, if the tag stands on it. */
static void reveal(json_t *params, const char *asset)
{
    static const char *const lists[] = { "hidden", "ghost" };
    json_t *isolate = json_object_get(params, "isolate"), *id = json_string(asset);
    bool is_isolated = json_array_size(isolate) == 0;
    for (size_t i = 0; i < sizeof(lists) / sizeof(lists[0]); i++) {
        json_t *left = json_array(), *one;
        size_t at;
        json_array_foreach(json_object_get(params, lists[i]), at, one) if (!json_equal(one, id)) json_array_append(left, one);
        json_object_set_new(params, lists[i], left);
    }
    for (size_t i = 0; i < json_array_size(isolate); i++)
        is_isolated |= json_equal(json_array_get(isolate, i), id) != 0;
    if (!is_isolated) {
        json_t *more = json_copy(isolate);
        json_array_append(more, id);
        json_object_set_new(params, "isolate", more);
    }
    json_decref(id);
}

/* Another side may be better, or what stands before the place is seen through. A tile stays with the first, as in the page. */
static void begin_sight(struct view_pane *pane, const struct model *model, int tag, const struct camera *camera, const json_t *params)
{
    const struct plant_tag *of = &model->plant.tags[tag];
    struct view_sight *sight = &pane->sight;
    if (pane->tile.display || !of->has_position || of->asset < 0 ||
        !project(camera, pane->width_px, pane->height_px, of->position_m, &sight->x_px, &sight->y_px))
        return;
    snprintf(sight->tag, sizeof(sight->tag), "%s", of->name);
    snprintf(sight->asset, sizeof(sight->asset), "%s", model->plant.assets[of->asset].id);
    memcpy(sight->place_m, of->position_m, sizeof(sight->place_m));
    sight->width_px = pane->width_px;
    sight->height_px = pane->height_px;
    sight->first = *camera;
    json_decref(sight->ghosts);
    sight->ghosts = json_deep_copy(json_object_get(params, "ghost"));
    sight->params_seq = &pane->params_seq;
    view_sight_begin(sight, pane->link);
}

void view_pane_tick(struct view_pane *pane, int64_t now_ns)
{
    struct camera better;
    if (view_sight_tick(&pane->sight, pane->link, now_ns, &better))
        post_camera(pane, view_address_camera_message(&better));
}

void view_pane_show(struct view_pane *pane, const struct model *model, const char *address)
{
    static const char *const engineers[] = { "fill", "strength", "decay", "power", "radius_m", "reach_m", "sensors" };
    json_t *given = view_address_params(address), *camera = view_address_camera(address);
    json_t *params = plain_params(pane, model, json_string_value(json_object_get(given, "group")));
    json_object_update(params, given);
    json_decref(given);
    for (size_t i = 0; i < sizeof(engineers) / sizeof(engineers[0]) && !pane->engineer; i++)
        json_object_del(params, engineers[i]);
    if (!camera) {
        struct camera whole = find_camera(pane, model, params, -1);
        camera = view_address_camera_message(&whole);
    }
    ask(pane, params, camera);
}

void view_pane_show_tag(struct view_pane *pane, const struct model *model, int tag)
{
    const struct plant_tag *of = &model->plant.tags[tag];
    json_t *params = plain_params(pane, model, of->group >= 0 ? model->plant.groups[of->group].id : NULL);
    if (of->asset >= 0)
        reveal(params, model->plant.assets[of->asset].id);
    struct camera camera = find_camera(pane, model, params, tag);
    json_incref(params);
    ask(pane, params, view_address_camera_message(&camera));
    begin_sight(pane, model, tag, &camera, params);
    json_decref(params);
}

/* --- what comes --------------------------------------------------------------------------------------------------------------------- */

static void on_welcome(struct view_pane *pane, const json_t *message)
{
    const char *role = json_string_value(json_object_get(message, "role"));
    const char *configuration = json_string_value(json_object_get(json_object_get(message, "plant"), "configuration"));
    view_pane_clear(pane);
    json_decref(pane->start);
    pane->start = json_deep_copy(json_object_get(message, "view"));
    pane->engineer = role && !strcmp(role, "engineer");
    snprintf(pane->configuration, sizeof(pane->configuration), "%s", configuration ? configuration : "");
    pane->camera_seq = pane->params_seq = pane->view_seq = pane->told_seq = 0;
    pane->greeted = true;
    pane->missed = false;
}

static uint32_t quality_at(const json_t *row, size_t index)
{
    static const uint32_t qualities[] = { QUALITY_GOOD, QUALITY_UNCERTAIN, QUALITY_BAD };
    json_int_t value = json_integer_value(json_array_get(row, index));
    return qualities[value >= 0 && value <= 2 ? value : 2];
}

static void take_value(struct frame_marker *marker, const json_t *row, size_t at)
{
    const json_t *value = json_array_get(row, at);
    marker->value = json_is_number(value) ? json_number_value(value) : NAN;
    marker->quality = quality_at(row, at + 1);
}

static void take_markers(struct view_pane *pane, const struct model *model, const json_t *rows)
{
    mem_free(pane->frame.markers);
    pane->frame.markers = mem_array(json_array_size(rows) + 1, sizeof(*pane->frame.markers));
    pane->frame.marker_count = 0;
    for (size_t i = 0; i < json_array_size(rows); i++) {
        const json_t *row = json_array_get(rows, i);
        json_int_t tag = json_integer_value(json_array_get(row, 0));
        if (tag < 0 || (size_t)tag >= model->plant.tag_count || model->plant.tags[tag].asset < 0)
            continue;
        struct frame_marker *marker = &pane->frame.markers[pane->frame.marker_count++];
        *marker = (struct frame_marker){ .tag = (int)tag, .x_px = (float)json_number_value(json_array_get(row, 1)) };
        marker->y_px = (float)json_number_value(json_array_get(row, 2));
        marker->occluded = json_integer_value(json_array_get(row, 3)) != 0;
        marker->half = json_integer_value(json_array_get(row, 4)) != 0;
        take_value(marker, row, 5);
    }
}

static void take_values(struct view_pane *pane, const json_t *rows)
{
    for (size_t i = 0; i < json_array_size(rows); i++) {
        const json_t *row = json_array_get(rows, i);
        for (size_t k = 0; k < pane->frame.marker_count; k++) {
            struct frame_marker *marker = &pane->frame.markers[k];
            if (marker->tag == json_integer_value(json_array_get(row, 0)) && marker->half == json_integer_value(json_array_get(row, 1)))
                take_value(marker, row, 2);
        }
    }
}

/* Isolines, or arrows, in place of those that were there. */
static void take_labels(struct view_pane *pane, const json_t *rows, bool arrows)
{
    struct frame *frame = &pane->frame;
    struct frame_label *labels = mem_array(frame->label_count + json_array_size(rows) + 1, sizeof(*labels));
    size_t count = 0;
    for (size_t i = 0; i < frame->label_count; i++)
        if (frame->labels[i].arrow != arrows)
            labels[count++] = frame->labels[i];
    for (size_t i = 0; i < json_array_size(rows); i++) {
        const json_t *row = json_array_get(rows, i);
        double numbers[8];
        for (size_t k = 0; k < 8; k++)
            numbers[k] = json_number_value(json_array_get(row, k));
        const double *n = numbers;
        labels[count++] = arrows ? (struct frame_label){ n[4],      (float)n[0], (float)n[1], (float)n[2],   (float)n[3],
                                                         n[6] != 0, 1,           n[5] != 0,   (uint16_t)n[7] }
                                 : (struct frame_label){ .value = n[0], .x_px = (float)n[1], .y_px = (float)n[2], .half = n[3] != 0 };
    }
    mem_free(frame->labels);
    frame->labels = labels;
    frame->label_count = count;
}

/* Legend and markers of a tile change with the picture that they belong to. */
static void take_told(struct view_pane *pane)
{
    for (int i = pane->coming_count - 1; i >= 0; i--)
        if (pane->coming[i].params_seq == pane->shown_params_seq) {
            if (pane->coming[i].known)
                pane->told = pane->coming[i].view;
            pane->told_seq = pane->coming[i].known ? UINT32_MAX : 0;
            pane->coming_count -= i + 1;
            memmove(pane->coming, pane->coming + i + 1, (size_t)pane->coming_count * sizeof(pane->coming[0]));
            break;
        }
    pane->is_current = pane->told_seq > 0; /* who leads chose it */
    pane->overlay_due = true;
}

static void hear_told(struct view_pane *pane, const struct model *model, const json_t *message, uint32_t params_seq)
{
    struct told_view next = { .params_seq = params_seq };
    next.known = read_view(model, message, pane->width_px, pane->height_px, &next.view);
    if (pane->coming_count == TOLD_COMING)
        memmove(pane->coming, pane->coming + 1, (size_t)--pane->coming_count * sizeof(pane->coming[0]));
    pane->coming[pane->coming_count++] = next;
    if (pane->picture)
        take_told(pane);
}

static void take_marker_message(struct view_pane *pane, const struct model *model, const json_t *message)
{
    if (json_object_get(message, "markers"))
        take_markers(pane, model, json_object_get(message, "markers"));
    take_values(pane, json_object_get(message, "values"));
    if (json_object_get(message, "isolines"))
        take_labels(pane, json_object_get(message, "isolines"), false);
    if (json_object_get(message, "arrows"))
        take_labels(pane, json_object_get(message, "arrows"), true);
    pane->overlay_due = true;
}

/* Those of a tile's pictures up to that frame. */
static void take_marker_messages(struct view_pane *pane, const struct model *model, uint32_t seq)
{
    const json_t *first;
    while ((first = json_array_get(pane->coming_markers, 0)) && json_integer_value(json_object_get(first, "seq")) <= (json_int_t)seq) {
        take_marker_message(pane, model, first);
        json_array_remove(pane->coming_markers, 0);
    }
}

static void keep_marker_message(struct view_pane *pane, const struct model *model, const json_t *message)
{
    if (!pane->coming_markers)
        pane->coming_markers = json_array();
    json_array_append(pane->coming_markers, (json_t *)message);
    if (json_array_size(pane->coming_markers) > MARKERS_COMING)
        take_marker_messages(pane, model, (uint32_t)json_integer_value(json_object_get(json_array_get(pane->coming_markers, 0), "seq")));
}

bool view_pane_fits(const struct view_pane *pane, const struct model *model)
{
    const char *now = json_string_value(json_object_get(json_object_get(model->welcome, "plant"), "configuration"));
    return model->welcome && now && !strncmp(now, pane->configuration, sizeof(pane->configuration) - 1);
}

void view_pane_hear(struct view_pane *pane, const struct model *model, const json_t *message)
{
    const char *type = json_string_value(json_object_get(message, "type"));
    if (!strcmp(type, "welcome")) {
        on_welcome(pane, message);
    } else if (!strcmp(type, "error")) {
        const char *text = json_string_value(json_object_get(message, "text")),
                   *about = json_string_value(json_object_get(message, "about"));
        if (about && !strcmp(about, "pick")) {
            view_sight_end(&pane->sight);
            return;
        }
        snprintf(pane->refused, sizeof(pane->refused), "%s", text ? text : "?");
    } else if (!view_pane_fits(pane, model)) { /* the one of two sessions was told of a new plant, the other will be */
        pane->missed = true;
    } else if (pane->tile.display && (!strcmp(type, "tiles") || !strcmp(type, "present"))) {
        view_tile_hear(&pane->tile, type, message);
    } else if (pane->tile.display && !strcmp(type, "following")) {
        hear_told(pane, model, message, (uint32_t)json_integer_value(json_object_get(message, "params_seq")));
    } else if (pane->tile.display && !strcmp(type, "params")) {
        hear_told(pane, model, message, (uint32_t)json_integer_value(json_object_get(message, "seq")));
    } else if (!strcmp(type, "picked")) {
        struct camera better;
        if (view_sight_hear(&pane->sight, pane->link, message, &better))
            post_camera(pane, view_address_camera_message(&better));
    } else if (!strcmp(type, "params")) {
        if (read_view(model, message, pane->width_px, pane->height_px, &pane->told))
            pane->told_seq = (uint32_t)json_integer_value(json_object_get(message, "seq"));
    } else if (!strcmp(type, "markers") && pane->tile.display) {
        keep_marker_message(pane, model, message);
    } else if (!strcmp(type, "markers")) {
        take_marker_message(pane, model, message);
    }
}

/* --- pictures ----------------------------------------------------------------------------------------------------------------------- */

static bool reserve_canvas(struct view_pane *pane, int width_px, int height_px)
{
    if (pane->canvas && pane->canvas_width_px == width_px && pane->canvas_height_px == height_px)
        return true;
    mem_free(pane->canvas);
    pane->canvas = mem_try_array((size_t)width_px * (size_t)height_px, 4);
    pane->canvas_width_px = width_px;
    pane->canvas_height_px = height_px;
    return pane->canvas != NULL;
}

static void put_part(struct view_pane *pane, const struct wire_frame *frame)
{
    const uint8_t *from = decoder_pixels(pane->decoder);
    size_t row_bytes = (size_t)frame->width_px * 4, stride = (size_t)pane->canvas_width_px * 4;
    for (size_t y = 0; y < frame->height_px; y++)
        memcpy(pane->canvas + (frame->y_px + y) * stride + (size_t)frame->x_px * 4, from + y * row_bytes, row_bytes);
}

/* Whether what is seen is that large. */
static bool has_size(const struct view_pane *pane, int width_px, int height_px)
{
    return pane->picture && cairo_image_surface_get_width(pane->picture) == width_px &&
           cairo_image_surface_get_height(pane->picture) == height_px;
}

/* The canvas holds the picture before the one that is seen, where the two were exchanged: a part is to be put over the newest. */
static void renew_canvas(struct view_pane *pane, pthread_mutex_t *lock, const struct wire_frame *frame)
{
    bool is_all = frame->width_px == frame->full_width_px && frame->height_px == frame->full_height_px;
    if (!is_all && pane->canvas_is_old) {
        pthread_mutex_lock(lock);
        if (has_size(pane, pane->canvas_width_px, pane->canvas_height_px))
            memcpy(pane->canvas, pane->pixels, (size_t)pane->canvas_width_px * (size_t)pane->canvas_height_px * 4);
        pthread_mutex_unlock(lock);
    }
    pane->canvas_is_old = false;
}

/* Takes the pixels over, of mem_try_array(). Returns those that were seen before, if they are as large; else NULL. model: of a tile. */
static uint8_t *show_pixels(struct view_pane *pane, const struct model *model, const struct wire_frame *frame, uint8_t *pixels)
{
    int width_px = frame->full_width_px, height_px = frame->full_height_px;
    uint8_t *before = has_size(pane, width_px, height_px) ? pane->pixels : NULL;
    if (before)
        pane->pixels = NULL;
    drop_picture(pane);
    pane->pixels = pixels;
    pane->picture = cairo_image_surface_create_for_data(pixels, CAIRO_FORMAT_RGB24, width_px, height_px, 4 * width_px);
    struct camera *camera = &pane->frame.view.camera;
    for (int i = 0; i < 3; i++) {
        camera->eye_m[i] = (double)frame->eye_m[i];
        camera->target_m[i] = (double)frame->target_m[i];
        camera->up[i] = (double)frame->up[i];
    }
    camera->fov_deg = (double)frame->fov_deg;
    camera->height_m = (double)frame->height_m;
    pane->is_current = pane->view_seq > 0 && frame->camera_seq >= pane->camera_seq && frame->params_seq >= pane->view_seq &&
                       pane->told_seq >= pane->view_seq;
    if (pane->tile.display) {
        pane->shown_params_seq = frame->params_seq;
        take_told(pane);
        take_marker_messages(pane, model, frame->seq);
    }
    pane->frame.data_utc_ns = (int64_t)frame->data_time_us * 1000;
    pane->shown_ns = clock_mono_ns();
    pane->frames++;
    pane->overlay_due = true;
    return before;
}

bool view_pane_decode(struct view_pane *pane, pthread_mutex_t *lock, const struct wire_frame *frame, const uint8_t *payload)
{
    if (!pane->decoder && !(pane->decoder = decoder_create()))
        return false;
    if (pane->by_gpu && !decoder_use_hardware(pane->decoder))
        pane->by_gpu = false;
    if (!decoder_decode(pane->decoder, frame, payload) || !reserve_canvas(pane, frame->full_width_px, frame->full_height_px))
        return false;
    bool last = !(frame->flags & WIRE_FLAG_MORE);
    if (frame->codec != WIRE_CODEC_H264 || last) {
        renew_canvas(pane, lock, frame);
        put_part(pane, frame);
    }
    if (!last)
        return true;
    pthread_mutex_lock(lock);
    if (pane->greeted && pane->tile.display) {
        view_tile_keep(&pane->tile, frame, pane->canvas);
    } else if (pane->greeted) {
        pane->canvas = show_pixels(pane, NULL, frame, pane->canvas);
        pane->canvas_is_old = true;
    }
    pthread_mutex_unlock(lock);
    return true;
}

void view_pane_move(struct view_pane *pane, struct burn_shift shift)
{
    pane->overlay_due |= shift.x_px != pane->shift.x_px || shift.y_px != pane->shift.y_px;
    pane->shift = shift;
}

bool view_pane_flip(struct view_pane *pane, const struct model *model, int64_t now_us)
{
    struct tile_picture picture;
    if (!view_tile_take(&pane->tile, now_us, &picture))
        return false;
    mem_free(show_pixels(pane, model, &picture.frame, picture.pixels));
    return true;
}

/* --- drawing ------------------------------------------------------------------------------------------------------------------------ */

/* Of the picture that a tile is a part of; of others the picture is the pane. A split one has the place in its left half. */
bool view_pane_project(const struct view_pane *pane, const double place_m[3], double *x, double *y)
{
    const double *part = pane->tile.part;
    bool is_tile = pane->tile.display > 0;
    double width = is_tile ? pane->width_px / part[2] : pane->width_px, height = is_tile ? pane->height_px / part[3] : pane->height_px;
    double shown = pane->told.split ? floor(width / 2) : width;
    if ((is_tile && !(part[2] > 0 && part[3] > 0)) || !project(&pane->frame.view.camera, shown, height, place_m, x, y) || *x < 0 ||
        *x >= shown || *y < 0 || *y >= height)
        return false;
    *x -= is_tile ? part[0] * width : 0;
    *y -= is_tile ? part[1] * height : 0;
    return true;
}

/* Markers of the picture, in pixels of the pane; and of alarms that it does not show, as of another group, or behind something. */
static void collect_markers(const struct view_pane *pane, const struct model *model, struct frame *frame)
{
    double x, y, across = (double)pane->width_px / cairo_image_surface_get_width(pane->picture),
                 down = (double)pane->height_px / cairo_image_surface_get_height(pane->picture);
    frame->markers = mem_array(pane->frame.marker_count + model->list_count + 1, sizeof(*frame->markers));
    frame->labels = mem_array(pane->frame.label_count + 1, sizeof(*frame->labels));
    for (size_t i = 0; i < pane->frame.marker_count; i++) {
        frame->markers[i] = pane->frame.markers[i];
        frame->markers[i].x_px *= (float)across;
        frame->markers[i].y_px *= (float)down;
    }
    frame->marker_count = pane->frame.marker_count;
    for (size_t i = 0; i < pane->frame.label_count; i++) {
        frame->labels[i] = pane->frame.labels[i];
        frame->labels[i].x_px *= (float)across;
        frame->labels[i].y_px *= (float)down;
    }
    frame->label_count = pane->frame.label_count;
    for (size_t i = 0; i < model->list_count; i++) {
        int tag = model->list[i].tag;
        bool known = tag < 0 || model->plant.tags[tag].asset < 0 || !model->plant.tags[tag].has_position;
        for (size_t k = 0; k < frame->marker_count && !known; k++)
            known = frame->markers[k].tag == tag;
        if (known || !view_pane_project(pane, model->plant.tags[tag].position_m, &x, &y) || x < 0 || x >= pane->width_px || y < 0 ||
            y >= pane->height_px)
            continue;
        const struct reading *reading = &model->snapshot->readings[tag];
        frame->markers[frame->marker_count++] = (struct frame_marker){
            .tag = tag, .x_px = (float)x, .y_px = (float)y, .occluded = 1, .quality = reading->quality, .value = reading->value
        };
    }
}

/* Onto the picture that was drawn with the upper left corner there, in whole pixels of an image. */
static void draw_overlay(struct view_pane *pane, const struct model *model, cairo_surface_t *image, int x, int y)
{
    struct frame frame = { .width_px = pane->width_px, .height_px = pane->height_px, .view = pane->told, .oldest_age_ns = INT64_MAX };
    int stride = cairo_image_surface_get_stride(image);
    cairo_surface_flush(image);
    cairo_surface_t *part = cairo_image_surface_create_for_data(cairo_image_surface_get_data(image) + (ptrdiff_t)y * stride + 4 * x,
                                                                CAIRO_FORMAT_RGB24, pane->width_px, pane->height_px, stride);
    frame.view.camera = pane->frame.view.camera;
    frame.view.width_px = pane->width_px;
    frame.view.height_px = pane->height_px;
    collect_markers(pane, model, &frame);
    if (pane->tile.display && pane->tile.display != pane->tile.columns * pane->tile.rows)
        frame.view.look = LOOK_MATERIALS; /* the legend stands once on the wall: at its right edge */
    overlay_draw_pane(part, &frame, &model->scene, model->snapshot, pane->unit, &pane->shift);
    mem_free(frame.markers);
    mem_free(frame.labels);
    cairo_surface_finish(part);
    cairo_surface_destroy(part);
    cairo_surface_mark_dirty(image);
    pane->overlay_due = false;
}

bool view_pane_draw(struct view_pane *pane, const struct model *model, cairo_t *cairo, int x, int y)
{
    if (!pane->picture || !pane->is_current || !view_pane_fits(pane, model))
        return false;
    int width_px = cairo_image_surface_get_width(pane->picture), height_px = cairo_image_surface_get_height(pane->picture);
    cairo_save(cairo);
    cairo_translate(cairo, x, y);
    cairo_scale(cairo, (double)pane->width_px / width_px, (double)pane->height_px / height_px);
    cairo_set_source_surface(cairo, pane->picture, 0, 0);
    cairo_pattern_set_extend(cairo_get_source(cairo), CAIRO_EXTEND_PAD);
    cairo_rectangle(cairo, 0, 0, width_px, height_px);
    cairo_fill(cairo);
    cairo_restore(cairo);
    draw_overlay(pane, model, cairo_get_target(cairo), x, y);
    return true;
}
