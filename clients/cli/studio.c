/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws a prepared plant, with values of a file or of the past. */
#include "studio.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "alarm/then.h"
#include "base/atomic_file.h"
#include "base/clock.h"
#include "base/mem.h"
#include "encode/encoder.h"
#include "field/colormap.h"
#include "base/when.h"
#include "net/message/query.h"
#include "plant/image_ramp.h"
#include "render/overlay/overlay.h"
#include "value/alarm.h"
#include "values.h"

static bool load_baseline(struct studio *studio, struct snapshot_options *options, struct diag *diag)
{
    static const char *const name = "baseline";
    if (!options->baseline)
        return true;
    struct snapshot *snapshot = snapshot_create(studio->plant->tag_count);
    bool good = values_read(studio->plant, options->baseline, snapshot, diag) && snapshot_add_arg(options, "baseline", name);
    baselines_set(studio->baselines, name, snapshot);
    snapshot_destroy(&snapshot);
    return good;
}

/* Without those of another picture. */
static bool load_values(struct studio *studio, struct snapshot_options *options, struct diag *diag)
{
    bool good = true;
    studio->turn++;
    snapshot_destroy(&studio->snapshot);
    studio->snapshot = snapshot_create(studio->plant->tag_count);
    studio->snapshot->taken_mono_ns = clock_mono_ns();
    studio->snapshot->taken_utc_ns = options->at ? options->at_us * 1000 : clock_utc_ns();
    for (size_t i = 0; i < options->value_count; i++)
        good = values_read(studio->plant, options->values[i], studio->snapshot, diag) && good;
    if (good)
        alarm_by_limits(studio->plant, studio->snapshot);
    for (size_t i = 0; i < studio->plant->tag_count; i++)
        studio->snapshot->readings[i].changes += studio->turn;
    return load_baseline(studio, options, diag) && good;
}

static bool load_plant(struct studio *studio, struct snapshot_options *options)
{
    struct diag diag = { 0 };
    studio->plant = plant_load(options->from, &diag);
    studio->baselines = baselines_create();
    if (studio->plant) {
        setenv("TZ", studio->plant->time_zone, 1);
        tzset();
    }
    bool good = studio->plant && load_values(studio, options, &diag);
    diag_print(&diag, stderr);
    diag_finish(&diag);
    return good;
}

static bool load_scene(struct studio *studio, const struct snapshot_options *options)
{
    char *folder = options->prepared ? mem_strdup(options->prepared) : plant_prepared_folder(studio->plant);
    studio->scene = scene_create(studio->log, studio->plant, folder);
    mem_free(folder);
    return studio->scene != NULL;
}

static void set_up_field(struct studio *studio)
{
    studio->workers = workers_create(0);
    studio->field = field_create(studio->workers, studio->scene);
    field_set_baselines(studio->field, studio->baselines);
}

bool studio_open_gl(struct studio *studio, const struct snapshot_options *options)
{
    studio->gl = gl_create(studio->log, options->gl, options->has_gl_device ? &options->gl_device : NULL);
    if (studio->gl)
        studio->renderer = renderer_create(studio->log, studio->gl, studio->scene, studio->field);
    if (studio->renderer)
        renderer_set_per_fragment(studio->renderer, options->per_fragment);
    return studio->renderer != NULL;
}

/* Those of the plant, and images that stand where a name could. */
static bool add_colormaps(const struct studio *studio, const struct snapshot_options *options)
{
    static const char name[] = "colormap=";
    colormaps_of_plant(studio->plant);
    for (size_t i = 0; i < options->arg_count; i++) {
        const char *path = options->args[i] + sizeof(name) - 1;
        uint8_t rgb[256][3];
        char why[IMAGE_WHY_BYTES];
        if (strncmp(options->args[i], name, sizeof(name) - 1) != 0 || colormap_find(path) >= 0 || !strpbrk(path, "./"))
            continue;
        if (!image_ramp(path, rgb, why)) {
            fprintf(stderr, "plantcast: --colormap: %s: %s\n", path, why);
            return false;
        }
        colormap_add(path, (const uint8_t(*)[3])rgb);
    }
    return true;
}

static bool take_view(const struct studio *studio, const struct snapshot_options *options, struct view *view)
{
    struct message_error error;
    const struct params_world world = { .scene = studio->scene, .baselines = studio->baselines, .bare = options->no_overlay };
    bool good = query_parse(&world, ROLE_ENGINEER, (const char *const *)options->args, options->arg_count, view, NULL, &error);
    if (!good)
        fprintf(stderr, "plantcast: %s\n", error.text);
    return good;
}

int studio_open(struct studio *studio, struct snapshot_options *options, struct view *view)
{
    *studio = (struct studio){ .log = log_create(LOG_INFO) };
    if (!load_plant(studio, options) || !load_scene(studio, options))
        return 1;
    if (!add_colormaps(studio, options) || !take_view(studio, options, view))
        return 2;
    set_up_field(studio);
    return 0;
}

int studio_turn(struct studio *studio, struct snapshot_options *options, struct view *view)
{
    struct diag diag = { 0 };
    bool good = load_values(studio, options, &diag);
    diag_print(&diag, stderr);
    diag_finish(&diag);
    return !good ? 1 : take_view(studio, options, view) ? 0 : 2;
}

bool studio_open_history(struct studio *studio, const struct snapshot_options *options)
{
    char *folder = options->history ? mem_strdup(options->history) : plant_history_folder(studio->plant);
    studio->history = folder;
    studio->reader = history_reader_create(studio->log, folder);
    studio->tags = history_tags(studio->plant);
    bool good = history_span(studio->reader, &studio->first_us, &studio->last_us);
    if (!good)
        fprintf(stderr, "plantcast: %s: nothing was recorded here; --history names the folder\n", folder);
    return good;
}

bool studio_travel(struct studio *studio, int64_t at_us, struct view *view)
{
    if (at_us < studio->first_us || at_us > studio->last_us) {
        char at[WHEN_BYTES], first[WHEN_BYTES], last[WHEN_BYTES];
        when_print(at_us, at);
        when_print(studio->first_us, first);
        when_print(studio->last_us, last);
        fprintf(stderr, "plantcast: nothing was recorded at %s; it begins at %s and ends at %s\n", at, first, last);
        return false;
    }
    view_travel(view, at_us, 0);
    return history_at(studio->reader, studio->tags, at_us, studio->snapshot) == 0 &&
           alarms_then(studio->log, studio->reader, studio->history, studio->plant, studio->snapshot) == 0;
}

struct frame *studio_draw(struct studio *studio, const struct snapshot_options *options, struct view *view)
{
    view->tier = options->moving ? TIER_MOVING : TIER_STILL;
    struct frame *frame = canvas_draw(studio->renderer, view, studio->snapshot);
    if (frame) {
        frame_read_markers(frame, studio->snapshot, studio->baselines);
        frame->clock_unset = !view->at_us && !clock_utc_is_set();
    }
    if (frame && !options->no_overlay)
        overlay_draw(frame, studio->scene, studio->snapshot, NULL);
    return frame;
}

bool studio_save(struct studio *studio, struct frame *frame, const char *path)
{
    struct encoder *encoder = encoder_create(studio->log, "png", NULL);
    struct packet *packet = NULL;
    bool good = encoder && encoder_send(encoder, frame, &(struct encoder_params){ 0 }) == 0 && encoder_receive(encoder, &packet) == 0;
    int status = good ? atomic_file_put(path, packet->bytes, packet->count) : 0;
    if (status < 0)
        log_err(studio->log, "%s: %s", path, strerror(-status));
    packet_unref(&packet);
    encoder_destroy(&encoder);
    return good && status == 0;
}

void studio_close(struct studio *studio)
{
    history_reader_destroy(&studio->reader);
    mem_free(studio->tags);
    mem_free(studio->history);
    renderer_destroy(&studio->renderer);
    gl_destroy(&studio->gl);
    field_destroy(&studio->field);
    workers_destroy(&studio->workers);
    snapshot_destroy(&studio->snapshot);
    baselines_destroy(&studio->baselines);
    scene_destroy(&studio->scene);
    plant_destroy(&studio->plant);
    log_destroy(&studio->log);
}

