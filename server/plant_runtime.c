/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Creates, starts, hands over and ends the parts of the daemon that depend on the plant. */
#include "plant_runtime.h"

#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "scene/far_sensors.h"
#include "message/view_named.h"
#include "scene/scene_create.h"
#include "version.h"

/* --- files of the plant --------------------------------------------------------------------------------------------------- */

char *plant_runtime_prepared_folder(const struct server_params *params, const struct plant *plant)
{
    return params->prepared ? mem_strdup(params->prepared) : plant_prepared_folder(plant);
}

struct scene *plant_runtime_open_scene(struct log *log, const struct server_params *params, const struct plant *plant)
{
    char *folder = plant_runtime_prepared_folder(params, plant);
    struct scene *scene = scene_create(log, plant, folder);
    mem_free(folder);
    return scene;
}

static void warn_of_far_sensors(struct log *log, const struct scene *scene)
{
    size_t count;
    struct far_sensor *far = far_sensors_find(scene, &count);
    for (size_t i = 0; i < count && i < 10; i++)
        log_warn(log, "%s: sensor %s is %.3f m from the surface of %s (at most %.3f m is expected)", scene->plant->files.tags_path,
                 scene->plant->tags[far[i].sensor->tag].name, far[i].sensor->surface_distance_m, far[i].asset->plant->id, far[i].limit_m);
    if (count > 10)
        log_warn(log, "%s: %zu more sensors are far from the surface of their asset; plantcastd --check lists them",
                 scene->plant->files.tags_path, count - 10);
    mem_free(far);
}

static void warn_of_view(void *arg, const struct named_view *view, const char *wrong)
{
    const struct plant_runtime_context *context = arg;
    log_warn(context->log, "%s:%d: view %s: %s", context->params->plant_path, view->line, view->id, wrong);
}

struct plant_runtime *plant_runtime_read(const struct plant_runtime_context *context, struct diag *diag)
{
    struct plant_runtime *runtime = mem_new(sizeof(*runtime));
    const struct server_params *params = context->params;
    runtime->context = context;
    if (!(runtime->plant = plant_load(params->plant_path, diag)) ||
        !(runtime->services.scene = plant_runtime_open_scene(context->log, params, runtime->plant))) {
        plant_runtime_destroy(&runtime);
        return NULL;
    }
    warn_of_far_sensors(context->log, runtime->services.scene);
    view_named_check_all(runtime->services.scene, warn_of_view, (void *)context);
    runtime->services.store = store_create(runtime->plant);
    runtime->services.clock = context->clock;
    runtime->services.baselines = baselines_create();
    runtime->services.snapshot_cache = snapshot_cache_create();
    if (!runtime->plant->history.off && params->role != SERVER_RENDER)
        runtime->services.history_folder = params->history ? mem_strdup(params->history) : plant_history_folder(runtime->plant);
    return runtime;
}

/* --- life cycle ----------------------------------------------------------------------------------------------------------- */

/* Returns true if another daemon polls the devices and owns the alarms. */
static bool follows(const struct plant_runtime *runtime)
{
    return runtime->context->params->role == SERVER_RENDER || *runtime->context->follows;
}

static bool start_historian(struct plant_runtime *runtime, const struct plant_runtime *before)
{
    const struct plant_runtime_context *context = runtime->context;
    const struct historian_params params = { .log = context->log,
                                             .counters = context->counters,
                                             .plant = runtime->plant,
                                             .store = runtime->services.store,
                                             .folder = runtime->services.history_folder,
                                             .follows = before != NULL,
                                             .owed = before ? &before->owed : NULL,
                                             .stands_by = follows(runtime) };
    return !runtime->services.history_folder || (runtime->services.historian = historian_start(&params));
}

static bool start_alarm_service(struct plant_runtime *runtime, struct alarm_service *before)
{
    const struct plant_runtime_context *context = runtime->context;
    const struct alarm_service_params params = {
        .log = context->log,
        .counters = context->counters,
        .plant = runtime->plant,
        .store = runtime->services.store,
        .clock = runtime->services.clock,
        .folder = runtime->services.history_folder,
        .keep_days = runtime->plant->history.keep_days,
        .mirrors = follows(runtime),
        .before = before,
        .notify = context->notify,
        .notify_arg = context->notify_arg,
    };
    return (runtime->services.alarm_service = alarm_service_start(&params));
}

static bool start_notifier(struct plant_runtime *runtime)
{
    const struct notifier_params params = { .log = runtime->context->log,
                                            .counters = runtime->context->counters,
                                            .plant = runtime->plant,
                                            .alarm_service = runtime->services.alarm_service,
                                            .folder = runtime->services.history_folder,
                                            .kept = runtime->context->notify,
                                            .kept_arg = runtime->context->notify_arg };
    return !runtime->plant->notify || follows(runtime) || (runtime->services.notifier = notifier_start(&params));
}

static bool start_publisher(struct plant_runtime *runtime)
{
    const struct publisher_params params = { .log = runtime->context->log,
                                             .counters = runtime->context->counters,
                                             .plant = runtime->plant,
                                             .store = runtime->services.store,
                                             .alarm_service = runtime->services.alarm_service };
    return !runtime->plant->publish || follows(runtime) || (runtime->publisher = publisher_start(&params));
}

static bool start_other_plants(struct plant_runtime *runtime)
{
    return runtime->plant->screens.other_plant_count == 0 ||
           (runtime->services.other_plants = other_plants_start(runtime->context->log, runtime->plant, runtime->services.clock));
}

/* Creates the service for placing sensors, from data that is already loaded. The service does no work until a session uses it. */
static void start_placing(struct plant_runtime *runtime)
{
    const struct plant_runtime_context *context = runtime->context;
    char *folder = plant_runtime_prepared_folder(context->params, runtime->plant);
    struct refusal why;
    runtime->services.placing = placing_create(&(struct placing_params){ .log = context->log,
                                                                         .workers = context->workers,
                                                                         .scene = runtime->services.scene,
                                                                         .folder = folder,
                                                                         .notify = context->notify,
                                                                         .notify_arg = context->notify_arg });
    runtime->services.tag_list = tag_file_read(runtime->plant->files.tags_path, &why);
    if (!runtime->services.tag_list) {
        char text[REFUSAL_TEXT_BYTES];
        refusal_text(&why, text);
        log_warn(context->log, "%s", text);
    }
    mem_free(folder);
}

void plant_runtime_open_lists(struct plant_runtime *runtime)
{
    const struct plant_runtime_context *context = runtime->context;
    runtime->services.named_views = named_views_open(context->log, runtime->plant, runtime->services.history_folder, context->file_writer);
    runtime->services.notes = notes_open(context->log, runtime->services.history_folder, context->file_writer);
    runtime->services.short_links = short_links_open(context->log, runtime->services.history_folder, context->file_writer);
    runtime->services.wall_remote = wall_remote_open(context->log, runtime->plant, runtime->services.history_folder, context->file_writer);
    runtime->services.pairings = pairings_open(context->log, runtime->services.history_folder, context->file_writer);
    if (!runtime->plant->history.off)
        runtime->services.loop_checks =
            loop_checks_open(context->log, runtime->plant, runtime->services.history_folder, context->file_writer);
    if (runtime->services.render_service)
        render_service_set_loop_checks(runtime->services.render_service, runtime->services.loop_checks);
}

bool plant_runtime_start_recording(struct plant_runtime *runtime, struct plant_runtime *before)
{
    if (before)
        store_adopt(runtime->services.store, before->services.store);
    /* opens the lists of views, notes, loop checks and so on only at the daemon's start. During a reload, sessions of the old
       runtime may still change these files, so the event loop opens the lists later, when it switches to this runtime */
    if (!before)
        plant_runtime_open_lists(runtime);
    return start_historian(runtime, before) && start_alarm_service(runtime, before ? before->services.alarm_service : NULL) &&
           start_notifier(runtime) && start_publisher(runtime) && start_other_plants(runtime);
}

static bool start_core_link(struct plant_runtime *runtime)
{
    const struct plant_runtime_context *context = runtime->context;
    const struct server_params *server = context->params;
    struct core_link_params params = { .log = context->log,
                                       .counters = context->counters,
                                       .plant = runtime->plant,
                                       .models_hash = runtime->services.scene->models_hash,
                                       .store = runtime->services.store,
                                       .clock = runtime->services.clock,
                                       .alarm_service = runtime->services.alarm_service,
                                       .url_count = server->core_count,
                                       .token_path = server->core_token,
                                       .ca_path = server->core_ca,
                                       .version = PLANTCAST_VERSION,
                                       .node = server->node,
                                       .keeper = context->keeper,
                                       .historian = runtime->services.historian,
                                       .folder = runtime->services.history_folder,
                                       .notify = context->notify,
                                       .notify_arg = context->notify_arg };
    memcpy(params.urls, server->cores, sizeof(params.urls));
    return (runtime->services.core_link = core_link_start(&params));
}

bool plant_runtime_start_sources(struct plant_runtime *runtime)
{
    const struct plant_runtime_context *context = runtime->context;
    if (follows(runtime))
        return start_core_link(runtime);
    runtime->sources = mem_array(runtime->plant->source_count, sizeof(*runtime->sources));
    for (size_t i = 0; i < runtime->plant->source_count; i++)
        if (!(runtime->sources[i] = source_start(context->log, runtime->plant, (int)i, runtime->services.store, context->counters)))
            return false;
    if (runtime->plant->derived_count > 0)
        runtime->derived = derived_start(context->log, runtime->plant, runtime->services.store);
    return runtime->plant->derived_count == 0 || runtime->derived;
}

void plant_runtime_stop_following(struct plant_runtime *runtime)
{
    core_link_halt(runtime->services.core_link);
}

bool plant_runtime_lead(struct plant_runtime *runtime)
{
    core_link_stop(&runtime->services.core_link);
    *runtime->context->follows = false;
    clock_follow(runtime->services.clock, 0);
    if (runtime->services.historian)
        historian_lead(runtime->services.historian);
    alarm_service_lead(runtime->services.alarm_service);
    return start_notifier(runtime) && start_publisher(runtime) && plant_runtime_start_sources(runtime);
}

const char *plant_runtime_h264_library(const struct server_params *params)
{
    return params->h264 ? params->h264 : ENCODER_H264_LIBRARY;
}

bool plant_runtime_start_render_service(struct plant_runtime *runtime, const struct view *first, size_t first_count)
{
    const struct plant_runtime_context *context = runtime->context;
    const struct server_params *server = context->params;
    start_placing(runtime);
    struct render_service_params params = {
        .log = context->log,
        .gl = server->gl,
        .per_fragment = server->per_fragment,
        .gl_device = server->has_gl_device ? &server->gl_device : NULL,
        .scene = runtime->services.scene,
        .store = runtime->services.store,
        .clock = runtime->services.clock,
        .baselines = runtime->services.baselines,
        .snapshot_cache = runtime->services.snapshot_cache,
        .trials = placing_trials(runtime->services.placing),
        .workers = context->workers,
        .memory_bytes = server->memory_bytes,
        .h264_library = plant_runtime_h264_library(server),
        .counters = context->counters,
        .keeps_records = server->signing_key != NULL,
        .first = first,
        .first_count = first_count,
        .notify = context->notify,
        .notify_arg = context->notify_arg,
    };
    runtime->services.render_service = render_service_create(&params);
    if (runtime->services.render_service)
        render_service_set_loop_checks(runtime->services.render_service, runtime->services.loop_checks);
    return runtime->services.render_service != NULL;
}

static void stop_sources(struct plant_runtime *runtime)
{
    for (size_t i = 0; runtime->sources && i < runtime->plant->source_count; i++)
        source_stop(&runtime->sources[i]);
    source_stop(&runtime->derived);
    if (runtime->services.core_link)
        core_link_halt(runtime->services.core_link);
    mem_free(runtime->sources);
    runtime->sources = NULL;
}

void plant_runtime_hand_over(struct plant_runtime *runtime, const struct plant *next)
{
    stop_sources(runtime);
    historian_end(&runtime->services.historian, next, &runtime->owed);
    notifier_stop(&runtime->services.notifier);
    publisher_stop(&runtime->publisher);
    alarm_service_halt(runtime->services.alarm_service);
}

void plant_runtime_end_leading(struct plant_runtime *runtime)
{
    stop_sources(runtime);
    alarm_service_halt(runtime->services.alarm_service);
    if (runtime->services.notifier)
        notifier_halt(runtime->services.notifier);
    publisher_stop(&runtime->publisher);
    historian_stop(&runtime->services.historian);
}

void plant_runtime_destroy(struct plant_runtime **pointer)
{
    struct plant_runtime *runtime = *pointer;
    if (!runtime)
        return;
    render_service_destroy(&runtime->services.render_service);
    placing_destroy(&runtime->services.placing);
    named_views_close(&runtime->services.named_views);
    notes_close(&runtime->services.notes);
    short_links_close(&runtime->services.short_links);
    wall_remote_close(&runtime->services.wall_remote);
    other_plants_stop(&runtime->services.other_plants);
    pairings_close(&runtime->services.pairings);
    loop_checks_close(&runtime->services.loop_checks);
    mem_free(runtime->services.tag_list);
    stop_sources(runtime);
    notifier_stop(&runtime->services.notifier);
    publisher_stop(&runtime->publisher);
    core_link_stop(&runtime->services.core_link);
    alarm_service_stop(&runtime->services.alarm_service);
    historian_stop(&runtime->services.historian);
    store_destroy(&runtime->services.store);
    baselines_destroy(&runtime->services.baselines);
    if (runtime->services.snapshot_cache)
        snapshot_cache_destroy(&runtime->services.snapshot_cache);
    scene_destroy(&runtime->services.scene);
    plant_destroy(&runtime->plant);
    mem_free(runtime->services.history_folder);
    mem_free(runtime);
    *pointer = NULL;
}
