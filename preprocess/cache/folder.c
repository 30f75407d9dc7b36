/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Manages the folder of prepared files: asset files, their reports, and the manifest. */
#include "preprocess/cache/folder.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "base/text/json_text.h"
#include "base/text/text.h"
#include "preprocess/cache/build_cache.h"

#define KEY_DIGITS 16
#define MANIFEST "manifest.json"
/* name of the lock file in the folder of prepared files; it contains the id of the process that holds the lock, or held it last */
#define LOCK "lock"
#define LOCK_RETRY_DELAY_US 50000
#define ASSET ".asset"
#define REPORT ".report.json"
#define INFLUENCE ".influence"
#define REPORT_MAX_BYTES ((size_t)1 << 20)
#define MANIFEST_MAX_BYTES ((size_t)64 << 20)

char *folder_file_name(uint64_t key)
{
    return mem_printf("%016" PRIx64 ASSET, key);
}

static char *path_of(const char *folder, uint64_t key, const char *ending)
{
    return mem_printf("%s/%016" PRIx64 "%s", folder, key, ending);
}

char *folder_asset_path(const char *folder, uint64_t key)
{
    return path_of(folder, key, ASSET);
}

char *folder_influence_path(const char *folder, uint64_t key)
{
    return path_of(folder, key, INFLUENCE);
}

/* Returns the process id in the lock file, or 0 if there is none. */
static long holder_of(int fd)
{
    char text[32] = "";
    ssize_t got = pread(fd, text, sizeof(text) - 1, 0);
    return got > 0 ? strtol(text, NULL, 10) : 0;
}

int folder_lock(const char *folder, struct log *log, const atomic_bool *stop)
{
    char *path = mem_printf("%s/" LOCK, folder), own[32];
    int fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666), status = fd < 0 ? -1 : flock(fd, LOCK_EX | LOCK_NB);
    if (fd >= 0 && status != 0 && errno == EWOULDBLOCK)
        log_warn(log, "%s: process %ld is preparing this folder: waiting until that process ends", folder, holder_of(fd));
    while (fd >= 0 && status != 0 && errno == EWOULDBLOCK && !(stop && atomic_load(stop))) {
        usleep(LOCK_RETRY_DELAY_US);
        status = flock(fd, LOCK_EX | LOCK_NB);
    }
    int length = snprintf(own, sizeof(own), "%-10ld\n", (long)getpid());
    if (status == 0 && pwrite(fd, own, (size_t)length, 0) != length)
        log_warn(log, "%s: %s", path, strerror(errno));
    if (fd >= 0 && status != 0) {
        close(fd);
        fd = -1;
    }
    mem_free(path);
    return fd;
}

int folder_open(struct folder_file *file, const char *folder, uint64_t key, char why[200])
{
    struct stat st;
    char *path = path_of(folder, key, ASSET);
    int fd = open(path, O_RDONLY | O_CLOEXEC), result = -1;
    *file = (struct folder_file){ 0 };
    mem_free(path);
    if (fd < 0 && errno == ENOENT)
        return 0;
    if (fd < 0 || fstat(fd, &st) != 0) {
        snprintf(why, 200, "%s", strerror(errno));
        goto done;
    }
    if (!S_ISREG(st.st_mode) || st.st_size == 0) {
        snprintf(why, 200, "%s", S_ISREG(st.st_mode) ? "truncated: 0 bytes" : "not a file");
        goto done;
    }
    file->size = (size_t)st.st_size;
    file->bytes = mmap(NULL, file->size, PROT_READ, MAP_PRIVATE, fd, 0);
    if (file->bytes == MAP_FAILED) {
        file->bytes = NULL;
        snprintf(why, 200, "%s", strerror(errno));
        goto done;
    }
    if (!asset_view_init(&file->view, file->bytes, file->size, why))
        goto done;
    if (file->view.header->key != key) {
        snprintf(why, 200, "the file was made from other input (key %016" PRIx64 ", expected %016" PRIx64 ")", file->view.header->key, key);
        goto done;
    }
    result = 1;
done:
    if (fd >= 0)
        close(fd);
    if (result < 0)
        folder_close(file);
    return result;
}

bool folder_unpack(struct folder_file *file)
{
    return file->codes || asset_view_unpack(&file->view, &file->codes);
}

void folder_close(struct folder_file *file)
{
    free(file->codes); /* uses free(), not mem_free(), because asset_view_unpack() allocates with malloc() */
    if (file->bytes)
        munmap(file->bytes, file->size);
    *file = (struct folder_file){ 0 };
}

int folder_draft(struct folder_draft *draft, const char *folder, uint64_t key, size_t size)
{
    char *path = path_of(folder, key, ASSET);
    *draft = (struct folder_draft){ .size = size };
    int status = -atomic_file_begin(&draft->file, path, 0666);
    mem_free(path);
    if (status == 0)
        status = posix_fallocate(draft->file.fd, 0, (off_t)size);
    if (status == 0) {
        draft->bytes = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, draft->file.fd, 0);
        status = draft->bytes == MAP_FAILED ? errno : 0;
        draft->bytes = status ? NULL : draft->bytes;
    }
    if (status != 0)
        folder_draft_close(draft);
    return -status;
}

void folder_draft_send(const struct folder_draft *draft)
{
    /* on systems without sync_file_range(), nothing is written early: folder_put() writes the whole file */
    sync_file_range(draft->file.fd, 0, (off_t)draft->size, SYNC_FILE_RANGE_WRITE);
}

int folder_put(struct folder_draft *draft, const char *folder, uint64_t key, const char *report)
{
    char *path = path_of(folder, key, REPORT);
    int status = report ? atomic_file_put(path, report, strlen(report)) : 0;
    if (status == 0 && msync(draft->bytes, draft->size, MS_SYNC) != 0)
        status = -errno;
    if (status == 0)
        status = atomic_file_commit(&draft->file, false);
    mem_free(path);
    return status;
}

void folder_draft_close(struct folder_draft *draft)
{
    if (draft->bytes)
        munmap(draft->bytes, draft->size);
    atomic_file_abandon(&draft->file);
    *draft = (struct folder_draft){ 0 };
}

/* Parses the JSON text of a file in the folder of prepared files. Returns NULL if the text is damaged. loss: consequence of the damage, for
 * the log line. */
static json_t *parse(struct log *log, const char *path, const char *text, size_t size, const char *loss)
{
    json_error_t error;
    json_t *root = json_loadb(text, size, 0, &error);
    if (!root)
        log_warn(log, "%s:%d: damaged: %s; %s", path, error.line, error.text, loss);
    return root;
}

json_t *folder_report(struct log *log, const char *folder, uint64_t key)
{
    size_t size;
    char *path = path_of(folder, key, REPORT), *text = text_read_file(path, REPORT_MAX_BYTES, &size);
    json_t *report = text ? parse(log, path, text, size, "the report of plantcast-prep will not include this asset's figures") : NULL;
    mem_free(path);
    mem_free(text);
    return report;
}

static void add_surface(json_t *asset, const char *folder, uint64_t key)
{
    char *path = build_cache_path(folder, BUILD_CACHE_SURFACE, key);
    if (access(path, R_OK) == 0)
        json_object_set_new(asset, "surface", json_string(strrchr(path, '/') + 1));
    mem_free(path);
}

/* Adds a bit mask to an asset's manifest entry: the levels of detail in which subdivision left no error in linear interpolation
   between vertices. The daemon need not measure the errors of these levels (server/field/drawn_error.h). */
static void add_resolved(json_t *asset, struct log *log, const char *folder, uint64_t key)
{
    json_t *report = folder_report(log, folder, key), *level;
    json_int_t resolved = 0;
    size_t i;
    json_array_foreach(json_object_get(report, "levels"), i, level)
    {
        json_int_t left = json_integer_value(json_object_get(level, "limited_by_triangles")) +
                          json_integer_value(json_object_get(level, "limited_by_length")) +
                          json_integer_value(json_object_get(level, "limited_by_jumps"));
        resolved |= (json_int_t)(i < 62 && left == 0) << i;
    }
    json_object_set_new(asset, "resolved_levels", json_integer(resolved));
    json_decref(report);
}

/* Returns whether two manifest entries are of the same model, or are the same asset with the same recipe (hash of model and
 * cutting parameters). The hash `model` changes with panoramas too, and ids change when assets are renamed. */
static bool same_model(const json_t *a, const json_t *b)
{
    return json_equal(json_object_get(a, "model"), json_object_get(b, "model")) ||
           (json_equal(json_object_get(a, "id"), json_object_get(b, "id")) &&
            json_equal(json_object_get(a, "recipe"), json_object_get(b, "recipe")));
}

/* Adds the list of the model's textures and extensions that are not drawn to an asset's manifest entry. If this run did not
 * parse the model, copies the model's list from the old manifest. */
static void add_left_out(json_t *asset, const struct folder_entry *entry, const json_t *old_assets)
{
    json_t *texts = entry->left_out ? json_array() : NULL;
    for (size_t i = 0; entry->left_out && i < entry->left_out_count; i++)
        json_array_append_new(texts, json_of_text(entry->left_out[i]));
    for (size_t i = 0; !entry->left_out && !texts && i < json_array_size(old_assets); i++)
        if (same_model(json_array_get(old_assets, i), asset))
            texts = json_incref(json_object_get(json_array_get(old_assets, i), "left_out"));
    if (json_array_size(texts) > 0)
        json_object_set(asset, "left_out", texts);
    json_decref(texts);
}

/* Returns the text of the new manifest. old_root: contents of the old manifest; NULL: there is none. */
static char *manifest_text(struct log *log, const char *folder, const struct folder_entry *entries, size_t count, const json_t *old_root)
{
    json_t *assets = json_array(), *root = json_pack("{s:i, s:o}", "format", 2, "assets", assets);
    for (size_t i = 0; i < count; i++) {
        char key[KEY_DIGITS + 1], recipe[KEY_DIGITS + 1], model[KEY_DIGITS + 1], cuts[KEY_DIGITS + 1];
        char *file = folder_file_name(entries[i].key);
        snprintf(key, sizeof(key), "%016" PRIx64, entries[i].key);
        snprintf(recipe, sizeof(recipe), "%016" PRIx64, entries[i].recipe);
        snprintf(model, sizeof(model), "%016" PRIx64, entries[i].model);
        snprintf(cuts, sizeof(cuts), "%016" PRIx64, entries[i].cuts);
        json_t *placement = json_array(), *tags = json_array();
        for (size_t n = 0; n < 16; n++)
            json_array_append_new(placement, json_real(entries[i].placement[n]));
        for (size_t t = 0; t < entries[i].tag_count; t++)
            json_array_append_new(tags, json_string(entries[i].tags[t]));
        json_t *asset = json_pack("{s:s, s:s, s:s, s:s, s:s, s:s, s:o, s:o}", "id", entries[i].id, "file", file, "key", key, "recipe",
                                  recipe, "model", model, "cuts", cuts, "placement", placement, "tags", tags);
        if (entries[i].missing)
            json_object_set_new(asset, "missing", json_of_text(entries[i].missing));
        add_surface(asset, folder, entries[i].geometry_key);
        add_resolved(asset, log, folder, entries[i].key);
        add_left_out(asset, &entries[i], json_object_get(old_root, "assets"));
        json_array_append_new(assets, asset);
        mem_free(file);
    }
    char *text = json_dumps(root, JSON_COMPACT);
    json_decref(root);
    return text;
}

static uint64_t cache_key_of(const struct folder_entry *entry, enum build_cache_kind kind)
{
    return build_cache_needs_sensors(kind) ? entry->distances_key : entry->geometry_key;
}

/* Returns whether a file name begins with 16 hexadecimal digits and `ending`. *whole: true if the name ends there; false for
 * the temporary file of an interrupted write. */
static bool is_name(const char *name, const char *ending, bool *whole)
{
    if (strspn(name, "0123456789abcdef") != KEY_DIGITS || strncmp(name + KEY_DIGITS, ending, strlen(ending)) != 0)
        return false;
    const char *rest = name + KEY_DIGITS + strlen(ending);
    *whole = rest[0] == 0;
    return *whole || (strlen(rest) > 4 && strcmp(rest + strlen(rest) - 4, ".new") == 0);
}

/* Returns whether the file `name` can be deleted: no manifest entry has its key, or an interrupted write left it. *is_asset: true if it is
 * a complete asset file. */
static bool is_left_over(const char *name, const struct folder_entry *entries, size_t count, bool *is_asset)
{
    uint64_t key = strtoull(name, NULL, 16);
    bool whole, is_named = false;
    *is_asset = is_name(name, ASSET, &whole);
    if (*is_asset || is_name(name, REPORT, &whole) || is_name(name, INFLUENCE, &whole)) {
        for (size_t i = 0; i < count; i++)
            is_named |= entries[i].key == key;
        return !whole || !is_named;
    }
    for (int kind = 0; kind < BUILD_CACHE_KINDS; kind++) {
        const char *ending = build_cache_ending((enum build_cache_kind)kind);
        if (!ending || !is_name(name, ending, &whole))
            continue;
        for (size_t i = 0; i < count; i++)
            is_named |= cache_key_of(&entries[i], (enum build_cache_kind)kind) == key;
        return !whole || !is_named;
    }
    return false;
}

static void remove_left_overs(const char *folder, const struct folder_entry *entries, size_t count, size_t *removed)
{
    DIR *dir = opendir(folder);
    const struct dirent *file;
    bool is_asset;
    while (dir && (file = readdir(dir)) != NULL)
        if (is_left_over(file->d_name, entries, count, &is_asset) && unlinkat(dirfd(dir), file->d_name, 0) == 0)
            *removed += is_asset;
    if (dir)
        closedir(dir);
}

int folder_finish(struct log *log, const char *folder, const struct folder_entry *entries, size_t count, size_t *removed)
{
    char *path = mem_printf("%s/" MANIFEST, folder);
    size_t size = 0;
    char *old = text_read_file(path, MANIFEST_MAX_BYTES, &size);
    json_t *old_root = old ? parse(log, path, old, size,
                                   "the manifest is written again, without the textures and glTF extensions not drawn of assets that were "
                                   "not prepared again")
                           : NULL;
    char *text = manifest_text(log, folder, entries, count, old_root);
    json_decref(old_root);
    int status = text ? 0 : -ENOMEM;
    if (text && (!old || size != strlen(text) || memcmp(old, text, size) != 0))
        status = atomic_file_put(path, text, strlen(text));
    if (status == 0 && removed)
        remove_left_overs(folder, entries, count, removed);
    mem_free(old);
    free(text);
    mem_free(path);
    return status;
}
