/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the manifest with jansson. */
#include "scene/manifest.h"

#include <errno.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/text.h"

#define MANIFEST_FORMAT 2
#define MANIFEST_MAX_BYTES (16u * 1024 * 1024)

static json_t *load(struct log *log, const char *path)
{
    json_error_t error;
    size_t bytes;
    char *text = text_read_file(path, MANIFEST_MAX_BYTES, &bytes);
    if (!text) {
        log_err(log, "%s: cannot be read: %s", path, strerror(errno));
        return NULL;
    }
    json_t *root = json_loadb(text, bytes, JSON_REJECT_DUPLICATES, &error);
    if (!root)
        log_err(log, "%s:%d:%d: %s", path, error.line, error.column, error.text);
    mem_free(text);
    return root;
}

/* Returns whether `file` is a plain file name in the manifest's folder, without a path. */
static bool file_name_good(const char *file)
{
    return file && *file && *file != '.' && !strchr(file, '/');
}

static bool read_entry(struct log *log, struct manifest *manifest, size_t index, const json_t *item)
{
    const char *id = json_string_value(json_object_get(item, "id")), *file = json_string_value(json_object_get(item, "file"));
    const char *recipe = json_string_value(json_object_get(item, "recipe")), *model = json_string_value(json_object_get(item, "model"));
    if (!id || !file_name_good(file) || !recipe) {
        log_err(log, "%s: damaged list of prepared files: asset number %zu has no id, file or recipe; run plantcast-prep again",
                manifest->path, index);
        return false;
    }
    const char *cuts = json_string_value(json_object_get(item, "cuts"));
    const char *surface = json_string_value(json_object_get(item, "surface"));
    const char *missing = json_string_value(json_object_get(item, "missing"));
    struct manifest_entry *entry = &manifest->entries[index];
    *entry = (struct manifest_entry){ .id = mem_strdup(id),
                                      .file = mem_strdup(file),
                                      .surface = file_name_good(surface) ? mem_strdup(surface) : NULL,
                                      .missing = missing ? mem_strdup(missing) : NULL,
                                      .recipe = strtoull(recipe, NULL, 16),
                                      .model = model ? strtoull(model, NULL, 16) : 0,
                                      .cuts = cuts ? strtoull(cuts, NULL, 16) : 0 };
    entry->resolved_levels = (uint64_t)json_integer_value(json_object_get(item, "resolved_levels"));
    const json_t *left_out = json_object_get(item, "left_out");
    entry->left_out = mem_array(json_array_size(left_out) + 1, sizeof(*entry->left_out));
    for (size_t i = 0; i < json_array_size(left_out); i++) {
        const char *text = json_string_value(json_array_get(left_out, i));
        if (text)
            entry->left_out[entry->left_out_count++] = mem_strdup(text);
    }
    manifest->count = index + 1;
    return true;
}

bool manifest_read(struct log *log, const char *folder, struct manifest *manifest)
{
    *manifest = (struct manifest){ .path = mem_printf("%s/manifest.json", folder) };
    json_t *root = load(log, manifest->path);
    bool good = root;
    if (good && json_integer_value(json_object_get(root, "format")) != MANIFEST_FORMAT) {
        log_err(log, "%s: the prepared files are not in format %d, which this program requires; run plantcast-prep again", manifest->path,
                MANIFEST_FORMAT);
        good = false;
    }
    const json_t *assets = json_object_get(root, "assets");
    if (good && !json_is_array(assets)) {
        log_err(log, "%s: damaged list of prepared files: expected a list of assets; run plantcast-prep again", manifest->path);
        good = false;
    }
    if (good)
        manifest->entries = mem_array(json_array_size(assets), sizeof(*manifest->entries));
    for (size_t i = 0; good && i < json_array_size(assets); i++)
        good = read_entry(log, manifest, i, json_array_get(assets, i));
    json_decref(root);
    if (!good)
        manifest_finish(manifest);
    return good;
}

void manifest_finish(struct manifest *manifest)
{
    for (size_t i = 0; i < manifest->count; i++) {
        mem_free(manifest->entries[i].id);
        mem_free(manifest->entries[i].file);
        mem_free(manifest->entries[i].surface);
        mem_free(manifest->entries[i].missing);
        for (size_t t = 0; t < manifest->entries[i].left_out_count; t++)
            mem_free(manifest->entries[i].left_out[t]);
        mem_free(manifest->entries[i].left_out);
    }
    mem_free(manifest->entries);
    mem_free(manifest->path);
    *manifest = (struct manifest){ 0 };
}

const struct manifest_entry *manifest_find(const struct manifest *manifest, const char *id)
{
    for (size_t i = 0; i < manifest->count; i++)
        if (!strcmp(manifest->entries[i].id, id))
            return &manifest->entries[i];
    return NULL;
}
