/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws pictures of a plant without a daemon, from files made by plantcast-prep, with values from a file or from recorded
   history. */
#include "offline_renderer.h"
#include "saved_view.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "alarm/alarms_at_instant.h"
#include "base/files/atomic_file.h"
#include "base/clock.h"
#include "base/mem.h"
#include "encode/encoder.h"
#include "base/text/timestamp.h"
#include "message/view_query.h"
#include "plant/colormaps.h"
#include "plant/sections/image_ramp.h"
#include "render/overlay/overlay.h"
#include "render/split_view.h"
#include "scene/scene_create.h"
#include "value/alarm.h"
#include "clients/cli/readings/values.h"

static bool load_baseline(struct offline_renderer *offline, struct snapshot_options *options, struct diag *diag)
{
    static const char *const name = "baseline";
    if (!options->baseline)
        return true;
    struct snapshot *snapshot = snapshot_create(offline->plant->tag_count);
    bool good = values_read(offline->plant, options->baseline, snapshot, diag) && snapshot_add_arg(options, "baseline", name);
    baselines_set(offline->baselines, name, snapshot);
    snapshot_destroy(&snapshot);
    return good;
}

/* Reads the values to draw from the CSV file in the options; values of the previous picture are dropped. */
static bool load_values(struct offline_renderer *offline, struct snapshot_options *options, struct diag *diag)
{
    bool good = true;
    offline->turn++;
    snapshot_destroy(&offline->snapshot);
    offline->snapshot = snapshot_create(offline->plant->tag_count);
    offline->snapshot->taken_mono_ns = clock_mono_ns();
    offline->snapshot->taken_utc_ns = options->at ? options->at_us * 1000 : clock_utc_ns();
    for (size_t i = 0; i < options->value_count; i++)
        good = values_read(offline->plant, options->values[i], offline->snapshot, diag) && good;
    if (good)
        alarm_by_limits(offline->plant, offline->snapshot);
    for (size_t i = 0; i < offline->plant->tag_count; i++)
        offline->snapshot->readings[i].changes += offline->turn;
    return load_baseline(offline, options, diag) && good;
}

static bool load_plant(struct offline_renderer *offline, struct snapshot_options *options)
{
    struct diag diag = { 0 };
    offline->plant = plant_load(options->from, &diag);
    offline->baselines = baselines_create();
    if (offline->plant) {
        setenv("TZ", offline->plant->time_zone, 1);
        tzset();
    }
    bool good = offline->plant && load_values(offline, options, &diag);
    diag_print(&diag, stderr);
    diag_finish(&diag);
    return good;
}

static bool load_scene(struct offline_renderer *offline, const struct snapshot_options *options)
{
    char *folder = options->prepared ? mem_strdup(options->prepared) : plant_prepared_folder(offline->plant);
    offline->scene = scene_create(offline->log, offline->plant, folder);
    mem_free(folder);
    return offline->scene != NULL;
}

static void set_up_field(struct offline_renderer *offline)
{
    offline->workers = workers_create(0);
    offline->field = field_create(offline->workers, offline->scene);
    field_set_baselines(offline->field, offline->baselines);
}

bool offline_renderer_open_gl(struct offline_renderer *offline, const struct snapshot_options *options)
{
    offline->gl = gl_create(offline->log, options->gl, options->has_gl_device ? &options->gl_device : NULL);
    if (offline->gl)
        offline->renderer = renderer_create(offline->log, offline->gl, offline->scene, offline->field);
    if (offline->renderer)
        renderer_set_per_fragment(offline->renderer, options->per_fragment);
    return offline->renderer != NULL;
}

/* Adds the colour maps given as image files with --colormap. */
static bool add_colormaps(struct offline_renderer *offline, const struct snapshot_options *options)
{
    static const char name[] = "colormap=";
    for (size_t i = 0; i < options->arg_count; i++) {
        const char *path = options->args[i] + sizeof(name) - 1;
        uint8_t rgb[256][3];
        char why[IMAGE_WHY_BYTES];
        if (strncmp(options->args[i], name, sizeof(name) - 1) != 0 || colormap_find(offline->plant, path) >= 0 || !strpbrk(path, "./"))
            continue;
        bool read = image_ramp(path, rgb, why);
        if (!read || !colormap_add(offline->plant, path, (const uint8_t(*)[3])rgb)) {
            fprintf(stderr, "plantcast: --colormap: %s: %s\n", path,
                    read ? "this colour map cannot be added, because the plant already has 16, the maximum" : why);
            return false;
        }
    }
    return true;
}

bool offline_renderer_take_view(const struct offline_renderer *offline, const struct snapshot_options *options, struct view *view)
{
    struct message_error error;
    const struct params_context context = { .scene = offline->scene, .baselines = offline->baselines, .bare = options->no_overlay };
    bool good = view_query_parse(&context, ROLE_ENGINEER, (const char *const *)options->args, options->arg_count, view, NULL, &error);
    if (!good)
        fprintf(stderr, "plantcast: %s\n", error.text);
    return good;
}

bool offline_renderer_open_plant(struct offline_renderer *offline, struct snapshot_options *options)
{
    *offline = (struct offline_renderer){ .log = log_create(LOG_INFO) };
    if (!load_plant(offline, options) || !load_scene(offline, options))
        return false;
    set_up_field(offline);
    return true;
}

static void open_loop_checks(struct offline_renderer *offline, const struct snapshot_options *options)
{
    if (offline->plant->history.off)
        return;
    char *folder = snapshot_options_folder(options, offline->plant);
    offline->loop_checks = loop_checks_open(offline->log, offline->plant, folder, NULL);
    mem_free(folder);
}

int offline_renderer_open(struct offline_renderer *offline, struct snapshot_options *options, struct view *view)
{
    if (!offline_renderer_open_plant(offline, options))
        return 1;
    open_loop_checks(offline, options);
    if (options->view && !saved_view_add_from_plant(options, offline->log, offline->plant))
        return 1;
    return add_colormaps(offline, options) && offline_renderer_take_view(offline, options, view) ? 0 : 2;
}

int offline_renderer_reopen(struct offline_renderer *offline, struct snapshot_options *options, struct view *view)
{
    struct diag diag = { 0 };
    bool good = load_values(offline, options, &diag);
    diag_print(&diag, stderr);
    diag_finish(&diag);
    return !good ? 1 : offline_renderer_take_view(offline, options, view) ? 0 : 2;
}

bool offline_renderer_open_history(struct offline_renderer *offline, const struct snapshot_options *options)
{
    char *folder = snapshot_options_folder(options, offline->plant);
    offline->history = folder;
    offline->reader = history_reader_create(offline->log, folder);
    offline->tags = history_tags(offline->plant);
    bool good = history_span(offline->reader, &offline->first_us, &offline->last_us);
    if (!good)
        fprintf(stderr, "plantcast: %s: this folder has no recorded readings: name the history folder with --history\n", folder);
    return good;
}

bool offline_renderer_seek(struct offline_renderer *offline, int64_t at_us, struct view *view)
{
    if (at_us < offline->first_us || at_us > offline->last_us) {
        char at[TIMESTAMP_BYTES], first[TIMESTAMP_BYTES], last[TIMESTAMP_BYTES];
        timestamp_print(at_us, at);
        timestamp_print(offline->first_us, first);
        timestamp_print(offline->last_us, last);
        fprintf(stderr, "plantcast: no readings recorded at %s: the history begins at %s and ends at %s\n", at, first, last);
        return false;
    }
    view_set_instant(view, at_us, 0);
    return history_at(offline->reader, offline->tags, at_us, offline->snapshot) == 0 &&
           alarms_at_instant(offline->log, offline->reader, offline->history, offline->plant, offline->snapshot) == 0;
}

struct frame *offline_renderer_draw(struct offline_renderer *offline, const struct snapshot_options *options, struct view *view)
{
    view->tier = options->moving ? TIER_PREVIEW : TIER_REFINED;
    struct frame *frame = split_view_draw_now(offline->renderer, view, offline->snapshot);
    if (frame) {
        frame_read_markers(frame, offline->snapshot, offline->baselines);
        frame->clock_unset = !view->at_us && !clock_utc_is_set();
    }
    if (frame && !options->no_overlay)
        overlay_draw(frame, offline->scene, offline->snapshot, offline->loop_checks);
    return frame;
}

bool offline_renderer_save(struct offline_renderer *offline, struct frame *frame, const char *path)
{
    struct encoder *encoder = encoder_create(offline->log, "png", NULL);
    struct packet *packet = NULL;
    bool good = encoder && encoder_send(encoder, frame, &(struct encoder_params){ 0 }) == 0 && encoder_receive(encoder, &packet) == 0;
    int status = good ? atomic_file_put(path, packet->bytes, packet->count) : 0;
    if (status < 0)
        log_err(offline->log, "%s: %s", path, strerror(-status));
    packet_unref(&packet);
    encoder_destroy(&encoder);
    return good && status == 0;
}

void offline_renderer_close(struct offline_renderer *offline)
{
    history_reader_destroy(&offline->reader);
    mem_free(offline->tags);
    mem_free(offline->history);
    renderer_destroy(&offline->renderer);
    gl_destroy(&offline->gl);
    field_destroy(&offline->field);
    workers_destroy(&offline->workers);
    snapshot_destroy(&offline->snapshot);
    loop_checks_close(&offline->loop_checks);
    baselines_destroy(&offline->baselines);
    scene_destroy(&offline->scene);
    plant_destroy(&offline->plant);
    log_destroy(&offline->log);
}
