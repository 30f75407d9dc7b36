/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What depends on the plant: made, started, handed over, ended. */
#include "plant_runtime.h"

#include <string.h>

#include "base/mem.h"
#include "scene/far_sensors.h"
#include "field/colormap.h"
#include "scene/scene_create.h"

/* --- what lies on disk ----------------------------------------------------------------------------------------------------- */

char *plant_runtime_prepared_folder(const struct server_params *params, const struct plant *plant)
{
    return params->prepared ? mem_strdup(params->prepared) : plant_prepared_folder(plant);
}

struct scene *plant_runtime_open_scene(struct log *log, const struct server_params *params, const struct plant *plant)
{
    char *folder = plant_runtime_prepared_folder(params, plant);
    struct scene *scene = scene_create(log, plant, folder);
    if (!scene)
        log_err(log, "%s: the prepared files in %s cannot be used; run plantcast-prep %s", params->plant_path, folder, params->plant_path);
    mem_free(folder);
    return scene;
}

static void warn_of_far_sensors(struct log *log, const struct scene *scene)
{
    size_t count;
    struct far_sensor *far = far_sensors_find(scene, &count);
    for (size_t i = 0; i < count && i < 10; i++)
        log_warn(log, "%s: sensor %s is %.3f m from the surface of %s (at most %.3f m is expected)", scene->plant->tags_path,
                 scene->plant->tags[far[i].sensor->tag].name, far[i].sensor->surface_distance_m, far[i].asset->plant->id, far[i].limit_m);
    if (count > 10)
        log_warn(log, "%s: %zu more sensors are far from their surface; plantcastd --check lists them", scene->plant->tags_path,
                 count - 10);
    mem_free(far);
}

struct plant_runtime *plant_runtime_read(const struct plant_runtime_context *context, struct diag *diag)
{
    struct plant_runtime *loaded = mem_new(sizeof(*loaded));
    const struct server_params *params = context->params;
    loaded->context = context;
    if (!(loaded->plant = plant_load(params->plant_path, diag)) ||
        !(loaded->scene = plant_runtime_open_scene(context->log, params, loaded->plant))) {
        plant_runtime_destroy(&loaded);
        return NULL;
    }
    warn_of_far_sensors(context->log, loaded->scene);
    loaded->store = store_create(loaded->plant);
    loaded->baselines = baselines_create();
    loaded->snapshot_cache = snapshot_cache_create();
    if (!loaded->plant->history.off)
        loaded->history = params->history ? mem_strdup(params->history) : plant_history_folder(loaded->plant);
    return loaded;
}

/* --- life ------------------------------------------------------------------------------------------------------------------ */

static bool start_historian(struct plant_runtime *loaded, bool follows)
{
    const struct plant_runtime_context *context = loaded->context;
    const struct historian_params params = { .log = context->log,
                                             .counters = context->counters,
                                             .plant = loaded->plant,
                                             .store = loaded->store,
                                             .folder = loaded->history,
                                             .follows = follows };
    return !loaded->history || (loaded->historian = historian_start(&params));
}

static bool start_alarm_service(struct plant_runtime *loaded, struct alarm_service *before)
{
    const struct plant_runtime_context *context = loaded->context;
    const struct alarm_service_params params = {
        .log = context->log,
        .counters = context->counters,
        .plant = loaded->plant,
        .store = loaded->store,
        .folder = loaded->history,
        .keep_days = loaded->plant->history.keep_days,
        .before = before,
        .notify = context->notify,
        .notify_arg = context->notify_arg,
    };
    return (loaded->alarm_service = alarm_service_start(&params));
}

/* Made from what is loaded; works only once somebody asks. */
static void start_placing(struct plant_runtime *loaded)
{
    const struct plant_runtime_context *context = loaded->context;
    char *folder = plant_runtime_prepared_folder(context->params, loaded->plant), *why;
    loaded->placing = placing_create(&(struct placing_params){ .log = context->log,
                                                               .workers = context->workers,
                                                               .scene = loaded->scene,
                                                               .folder = folder,
                                                               .notify = context->notify,
                                                               .notify_arg = context->notify_arg });
    loaded->tag_list = tag_file_read(loaded->plant->tags_path, &why);
    if (why)
        log_warn(context->log, "%s", why);
    mem_free(why);
    mem_free(folder);
}

bool plant_runtime_start_recording(struct plant_runtime *loaded, struct plant_runtime *before)
{
    if (before)
        store_adopt(loaded->store, before->store);
    if (loaded->history)
        loaded->loop_checks = loop_checks_open(loaded->context->log, loaded->plant, loaded->history);
    if (loaded->painter)
        render_service_set_loop_checks(loaded->painter, loaded->loop_checks);
    return start_historian(loaded, before != NULL) && start_alarm_service(loaded, before ? before->alarm_service : NULL);
}

bool plant_runtime_start_sources(struct plant_runtime *loaded)
{
    const struct plant_runtime_context *context = loaded->context;
    loaded->sources = mem_array(loaded->plant->source_count, sizeof(*loaded->sources));
    for (size_t i = 0; i < loaded->plant->source_count; i++)
        if (!(loaded->sources[i] = source_start(context->log, loaded->plant, (int)i, loaded->store, context->counters)))
            return false;
    if (loaded->plant->derived_count > 0)
        loaded->derived = derived_start(context->log, loaded->plant, loaded->store);
    return loaded->plant->derived_count == 0 || loaded->derived;
}

const char *plant_runtime_h264_library(const struct server_params *params)
{
    return params->h264 ? params->h264 : ENCODER_H264_LIBRARY;
}

bool plant_runtime_start_render_service(struct plant_runtime *loaded, const struct view *first, size_t first_count)
{
    const struct plant_runtime_context *context = loaded->context;
    const struct server_params *server = context->params;
    start_placing(loaded);
    struct render_service_params params = {
        .log = context->log,
        .gl = server->gl,
        .per_fragment = server->per_fragment,
        .gl_device = server->has_gl_device ? &server->gl_device : NULL,
        .scene = loaded->scene,
        .store = loaded->store,
        .baselines = loaded->baselines,
        .snapshot_cache = loaded->snapshot_cache,
        .trials = placing_trials(loaded->placing),
        .workers = context->workers,
        .memory_bytes = server->memory_bytes,
        .h264_library = plant_runtime_h264_library(server),
        .counters = context->counters,
        .first = first,
        .first_count = first_count,
        .notify = context->notify,
        .notify_arg = context->notify_arg,
    };
    loaded->painter = render_service_create(&params);
    if (loaded->painter)
        render_service_set_loop_checks(loaded->painter, loaded->loop_checks);
    return loaded->painter != NULL;
}

static void stop_sources(struct plant_runtime *loaded)
{
    for (size_t i = 0; loaded->sources && i < loaded->plant->source_count; i++)
        source_stop(&loaded->sources[i]);
    source_stop(&loaded->derived);
    mem_free(loaded->sources);
    loaded->sources = NULL;
}

void plant_runtime_hand_over(struct plant_runtime *loaded, const struct plant *next)
{
    stop_sources(loaded);
    historian_end(&loaded->historian, next);
    alarm_service_halt(loaded->alarm_service);
}

struct net_plant plant_runtime_net_plant(const struct plant_runtime *loaded)
{
    return (struct net_plant){
        .scene = loaded->scene,
        .store = loaded->store,
        .painter = loaded->painter,
        .baselines = loaded->baselines,
        .snapshot_cache = loaded->snapshot_cache,
        .alarm_service = loaded->alarm_service,
        .placing = loaded->placing,
        .loop_checks = loaded->loop_checks,
        .tag_list = loaded->tag_list,
        .history_folder = loaded->history,
    };
}

void plant_runtime_destroy(struct plant_runtime **pointer)
{
    struct plant_runtime *loaded = *pointer;
    if (!loaded)
        return;
    render_service_destroy(&loaded->painter);
    placing_destroy(&loaded->placing);
    loop_checks_close(&loaded->loop_checks);
    mem_free(loaded->tag_list);
    stop_sources(loaded);
    alarm_service_stop(&loaded->alarm_service);
    historian_stop(&loaded->historian);
    store_destroy(&loaded->store);
    baselines_destroy(&loaded->baselines);
    if (loaded->snapshot_cache)
        snapshot_cache_destroy(&loaded->snapshot_cache);
    scene_destroy(&loaded->scene);
    plant_destroy(&loaded->plant);
    mem_free(loaded->history);
    mem_free(loaded);
    *pointer = NULL;
}
