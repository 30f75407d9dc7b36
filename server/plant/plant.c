/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads a plant file with its tag list, and finds the plant's folders. */
#include "plant/plant.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <xxhash.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "plant/plant_impl.h"
#include "plant/tags/expression.h"

enum { MAX_FILE_BYTES = 1 << 28 };

static char *folder_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    if (!slash)
        return mem_strdup(".");
    return slash == path ? mem_strdup("/.") : mem_printf("%.*s", (int)(slash - path), path);
}

/* Hashes the contents of plant file and tag list. The hash identifies the configuration: undoing a change restores the old hash. */
static void hash_files(struct plant_files *files)
{
    const char *const paths[] = { files->path, files->tags_path };
    char *const hashes[] = { files->plant_hash, files->tags_hash };
    XXH3_state_t *state = XXH3_createState();
    XXH3_64bits_reset(state);
    for (size_t i = 0; i < 2; i++) {
        size_t count = 0;
        char *bytes = paths[i] ? text_read_file(paths[i], MAX_FILE_BYTES, &count) : NULL;
        XXH3_64bits_update(state, &count, sizeof(count));
        if (bytes)
            XXH3_64bits_update(state, bytes, count);
        snprintf(hashes[i], sizeof(files->tags_hash), "%016llx", bytes ? (unsigned long long)XXH3_64bits(bytes, count) : 0);
        mem_free(bytes);
    }
    snprintf(files->hash, sizeof(files->hash), "%016llx", (unsigned long long)XXH3_64bits_digest(state));
    XXH3_freeState(state);
}

void plant_hash_on_disk(const struct plant *plant, char hash[17])
{
    struct plant_files now = plant->files;
    hash_files(&now);
    memcpy(hash, now.hash, sizeof(now.hash));
}

static int compare_ids(const void *pa, const void *pb, void *assets_ptr)
{
    const struct plant_asset *assets = assets_ptr;
    return strcmp(assets[*(const int *)pa].id, assets[*(const int *)pb].id);
}

static void sort_assets(struct plant *plant)
{
    plant->assets_by_id = mem_array(plant->asset_count, sizeof(*plant->assets_by_id));
    for (size_t i = 0; i < plant->asset_count; i++)
        plant->assets_by_id[i] = (int)i;
    qsort_r(plant->assets_by_id, plant->asset_count, sizeof(*plant->assets_by_id), compare_ids, plant->assets);
}

static struct plant *load(const char *path, bool keeps_orphans, bool without_models, struct diag *diag)
{
    int errors = diag->errors;
    struct plant *plant = mem_new(sizeof(*plant));
    plant->files.keeps_orphans = keeps_orphans;
    plant->files.without_models = without_models;
    plant->files.path = mem_strdup(path);
    plant->files.folder = folder_of(path);
    plant_file_read(plant, diag);
    if (plant->files.tags_path)
        tag_list_read(plant, diag);
    if (plant->files.tags_path && diag->errors == errors) {
        plant_tours_check(plant, diag);
        plant_walls_check(plant, diag);
    }
    if (plant->files.tags_path && diag->errors == errors)
        plant_influence_check(plant, diag);
    hash_files(&plant->files);
    if (diag->errors != errors)
        plant_destroy(&plant);
    else
        sort_assets(plant);
    return plant;
}

struct plant *plant_load(const char *path, struct diag *diag)
{
    return load(path, false, false, diag);
}

static struct plant *load_or_print(const char *path, bool without_models)
{
    struct diag diag = { 0 };
    struct plant *plant = load(path, false, without_models, &diag);
    if (!plant)
        diag_print(&diag, stderr);
    diag_finish(&diag);
    return plant;
}

struct plant *plant_load_or_print(const char *path)
{
    return load_or_print(path, false);
}

struct plant *plant_load_without_models(const char *path)
{
    return load_or_print(path, true);
}

struct plant *plant_load_with_orphans(const char *path, struct diag *diag)
{
    return load(path, true, false, diag);
}

static void free_assets(struct plant *plant)
{
    for (size_t i = 0; i < plant->asset_count; i++) {
        struct plant_asset *asset = &plant->assets[i];
        char *const texts[] = { asset->id, asset->tag, asset->description, asset->area, asset->model, asset->nodes };
        for (size_t k = 0; k < sizeof(texts) / sizeof(*texts); k++)
            mem_free(texts[k]);
        plant_properties_free(asset);
    }
    mem_free(plant->assets);
    mem_free(plant->assets_by_id);
}

static void free_groups(struct plant *plant)
{
    for (size_t i = 0; i < plant->group_count; i++) {
        mem_free(plant->groups[i].id);
        mem_free(plant->groups[i].quantity);
        mem_free(plant->groups[i].gp.fit);
        mem_free(plant->groups[i].unit);
    }
    mem_free(plant->groups);
}

static void free_sources(struct plant *plant)
{
    for (size_t i = 0; i < plant->source_count; i++) {
        struct plant_source *source = &plant->sources[i];
        mem_free(source->id);
        mem_free(source->kind);
        for (int h = 0; h < source->host_count; h++)
            mem_free(source->hosts[h]);
        mem_free(source->device);
        mem_free(source->heartbeat);
        mem_free(source->file);
        mem_free(source->login);
        plant_mqtt_finish(&source->mqtt);
        plant_opcua_finish(&source->opcua);
    }
    mem_free(plant->sources);
}

static void free_tags(struct plant *plant)
{
    for (size_t i = 0; i < plant->tag_count; i++) {
        struct plant_tag *tag = &plant->tags[i];
        char *const texts[] = { tag->name,         tag->description, tag->unit,       tag->scale.own_unit,  tag->signal.address,
                                tag->signal.topic, tag->signal.path, tag->place.node, tag->place.lost_asset };
        for (size_t k = 0; k < sizeof(texts) / sizeof(*texts); k++)
            mem_free(texts[k]);
        expression_destroy(&tag->expression);
    }
    mem_free(plant->tags);
    mem_free(plant->tags_by_name);
    mem_free(plant->derived);
}

void plant_destroy(struct plant **plant_ptr)
{
    struct plant *plant = *plant_ptr;
    if (!plant)
        return;
    free_assets(plant);
    free_groups(plant);
    free_sources(plant);
    free_tags(plant);
    for (size_t i = 0; i < plant->display.environment_count; i++) {
        mem_free(plant->display.environments[i].name);
        mem_free(plant->display.environments[i].path);
    }
    for (size_t i = 0; i < plant->display.link_count; i++) {
        mem_free(plant->display.links[i].name);
        mem_free(plant->display.links[i].url);
    }
    plant_views_free(plant);
    plant_tours_free(plant);
    plant_other_plants_free(plant);
    plant_walls_free(plant);
    plant_notify_free(&plant->notify);
    plant_publish_free(&plant->publish);
    for (size_t i = 0; i < plant->conversion_count; i++) {
        mem_free(plant->conversions[i].model);
        mem_free(plant->conversions[i].from);
        mem_free(plant->conversions[i].command);
        mem_free(plant->conversions[i].also);
    }
    mem_free(plant->conversions);
    mem_free(plant->history.folder);
    plant_postgres_finish(&plant->history.postgres);
    mem_free(plant->files.path);
    mem_free(plant->files.folder);
    mem_free(plant->files.tags_path);
    mem_free(plant->name);
    mem_free(plant->time_zone);
    mem_free(plant);
    *plant_ptr = NULL;
}

static char *beside(const struct plant *plant, const char *ending)
{
    const char *name = strrchr(plant->files.path, '/');
    name = name ? name + 1 : plant->files.path;
    const char *end = strrchr(name, '.');
    return mem_printf("%s/%.*s.%s", plant->files.folder, end && end > name ? (int)(end - name) : (int)strlen(name), name, ending);
}

/* Returns the absolute path of a file that need not exist; its folder must. Free with mem_free(). */
static char *absolute_path(const char *path)
{
    const char *slash = strrchr(path, '/');
    char *folder = slash ? mem_printf("%.*s", (int)(slash - path), path) : mem_strdup(".");
    char *real = *path == '/' ? NULL : realpath(folder, NULL);
    char *out = real ? mem_printf("%s/%s", real, slash ? slash + 1 : path) : mem_strdup(path);
    free(real);
    mem_free(folder);
    return out;
}

char *plant_service_folder(const char *path, const char *name)
{
    static const char installed[] = "/etc/plantcast/", file[] = "/plant.yaml";
    char *absolute = absolute_path(path);
    path = absolute;
    size_t length = strlen(path), before = sizeof(installed) - 1, after = sizeof(file) - 1;
    bool is = length > before + after && !strncmp(path, installed, before) && !strcmp(path + length - after, file);
    char *folder = is ? mem_printf("/var/lib/plantcast/%.*s/%s", (int)(length - before - after), path + before, name) : NULL;
    mem_free(absolute);
    return folder;
}

/* Returns `folder` if it is in use, or if the plant file does not belong to a systemd service. Otherwise returns that service's
   folder `name`. Takes ownership of `folder`. */
static char *or_of_service(const struct plant *plant, char *folder, bool in_use, const char *name)
{
    char *own = in_use ? NULL : plant_service_folder(plant->files.path, name);
    if (!own)
        return folder;
    mem_free(folder);
    return own;
}

char *plant_prepared_folder(const struct plant *plant)
{
    char *folder = beside(plant, "prepared");
    return or_of_service(plant, folder, access(folder, F_OK) == 0, "prepared");
}

/* Returns whether a folder exists and has entries; true, too, if it exists but cannot be read. */
static bool has_entries(const char *folder)
{
    DIR *dir = opendir(folder);
    int count = 0;
    if (!dir)
        return access(folder, F_OK) == 0;
    while (count <= 2 && readdir(dir)) /* `.` and `..` are entries of an empty folder */
        count++;
    closedir(dir);
    return count > 2;
}

char *plant_recorded_folder(const struct plant *plant)
{
    char *folder = plant_history_folder(plant);
    return or_of_service(plant, folder, has_entries(folder), "history");
}

char *plant_history_folder(const struct plant *plant)
{
    return plant->history.folder ? mem_strdup(plant->history.folder) : beside(plant, "history");
}

bool plant_tag_simulated(const struct plant *plant, int tag)
{
    const struct plant_tag *t = &plant->tags[tag];
    const int *inputs;
    size_t count = t->expression ? expression_inputs(t->expression, &inputs) : 0;
    for (size_t i = 0; i < count; i++)
        if (plant_tag_simulated(plant, inputs[i]))
            return true;
    return t->source >= 0 && plant->sources[t->source].simulated;
}
