/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws one picture of a prepared plant, without a daemon. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/text.h"
#include "encode/encoder.h"
#include "net/query.h"
#include "net/reply.h"
#include "plant/image_ramp.h"
#include "render/canvas.h"
#include "render/overlay.h"
#include "snapshot.h"
#include "value/alarm.h"
#include "values.h"

/* All that a picture needs; freed in the opposite order. */
struct studio {
    struct log *log;
    struct plant *plant;
    struct scene *scene;
    struct snapshot *snapshot;
    struct baselines *baselines;
    struct workers *workers;
    struct field *field;
    struct gl *gl;
    struct renderer *renderer;
};

static bool load_baseline(struct studio *studio, struct snapshot_options *options, struct diag *diag)
{
    static const char *const name = "baseline";
    studio->baselines = baselines_create();
    if (!options->baseline)
        return true;
    struct snapshot *snapshot = snapshot_create(studio->plant->tag_count);
    bool good = values_read(studio->plant, options->baseline, snapshot, diag) && snapshot_add_arg(options, "baseline", name);
    baselines_set(studio->baselines, name, snapshot);
    snapshot_destroy(&snapshot);
    return good;
}

static bool load_plant(struct studio *studio, struct snapshot_options *options)
{
    struct diag diag = { 0 };
    studio->plant = plant_load(options->from, &diag);
    bool good = studio->plant != NULL;
    if (good) {
        studio->snapshot = snapshot_create(studio->plant->tag_count);
        studio->snapshot->taken_mono_ns = clock_mono_ns();
        studio->snapshot->taken_utc_ns = options->at_utc_ns ? options->at_utc_ns : clock_utc_ns();
        setenv("TZ", studio->plant->time_zone, 1);
        tzset();
    }
    for (size_t i = 0; i < options->value_count && studio->plant; i++)
        good = values_read(studio->plant, options->values[i], studio->snapshot, &diag) && good;
    if (good)
        alarm_by_limits(studio->plant, studio->snapshot);
    good = good && load_baseline(studio, options, &diag);
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

static bool set_up_gl(struct studio *studio, const struct snapshot_options *options)
{
    studio->gl = gl_create(studio->log, options->gl, options->has_gl_device ? &options->gl_device : NULL);
    if (studio->gl)
        studio->renderer = renderer_create(studio->log, studio->gl, studio->scene, studio->field);
    if (studio->renderer)
        renderer_set_per_fragment(studio->renderer, options->per_fragment);
    return studio->renderer != NULL;
}

static void tear_down(struct studio *studio)
{
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

static bool save(struct studio *studio, struct frame *frame, const char *path)
{
    struct encoder *encoder = encoder_create(studio->log, "png", NULL);
    struct packet *packet = NULL;
    bool good = encoder && encoder_send(encoder, frame, &(struct encoder_params){ 0 }) == 0 && encoder_receive(encoder, &packet) == 0;
    int status = good ? text_write_file(path, packet->bytes, packet->count) : 0;
    if (status < 0)
        log_err(studio->log, "%s: %s", path, strerror(-status));
    packet_unref(&packet);
    encoder_destroy(&encoder);
    return good && status == 0;
}

static bool draw(struct studio *studio, const struct snapshot_options *options, struct view *view)
{
    view->tier = options->moving ? TIER_MOVING : TIER_STILL;
    struct frame *frame = canvas_draw(studio->renderer, view, studio->snapshot);
    if (!frame)
        return false;
    frame_read_markers(frame, studio->snapshot, studio->baselines);
    if (!options->no_overlay)
        overlay_draw(frame, studio->scene, studio->snapshot);
    log_info(studio->log, "%s: %dx%d, %d triangles, field %.1f ms, render %.1f ms", options->out, frame->width_px, frame->height_px,
             frame->triangles, frame->field_ns / 1e6, frame->render_ns / 1e6);
    bool good = save(studio, frame, options->out);
    frame_unref(&frame);
    return good;
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

static void print_pick(struct studio *studio, const struct snapshot_options *options, const struct view *view)
{
    struct pick_answer *answer = mem_new(sizeof(*answer));
    answer->order = (struct pick_order){ .view = *view, .x_px = options->place_px[0], .y_px = options->place_px[1] };
    pick_at(studio->scene, studio->field, view, studio->snapshot, answer->order.x_px, answer->order.y_px, &answer->pick);
    char *text = reply_picked_text(studio->plant, answer);
    puts(text);
    mem_free(text);
    mem_free(answer);
}

int snapshot_offline(struct snapshot_options *options)
{
    struct studio studio = { .log = log_create(LOG_INFO) };
    struct message_error error;
    struct view view;
    int code = 1;
    if (!load_plant(&studio, options) || !load_scene(&studio, options))
        goto end;
    if (!add_colormaps(&studio, options)) {
        code = 2;
        goto end;
    }
    const struct params_world world = { .scene = studio.scene, .baselines = studio.baselines };
    if (!query_parse(&world, ROLE_ENGINEER, (const char *const *)options->args, options->arg_count, &view, NULL, &error)) {
        fprintf(stderr, "plantcast: %s\n", error.text);
        code = 2;
        goto end;
    }
    set_up_field(&studio);
    if (options->pick)
        print_pick(&studio, options, &view);
    if (!options->out || (set_up_gl(&studio, options) && draw(&studio, options, &view)))
        code = 0;
end:
    tear_down(&studio);
    return code;
}
