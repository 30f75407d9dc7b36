/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decides which models must be generated again by comparing hashes of inputs and outputs with those of the last run. */
#include "preprocess/convert/convert.h"

#include <errno.h>
#include <glob.h>
#include <inttypes.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <xxhash.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "base/text/json_text.h"
#include "base/text/text.h"
#include "plant/models/model_header.h"
#include "preprocess/child/child.h"
#include "preprocess/child/child_paths.h"
#include "preprocess/child/work_folder.h"

static const size_t max_bytes = (size_t)16 << 30, memory_bytes = (size_t)12 << 30;

/* Appends to `out` the hash of a file, combined with the hash of the text `also`. Returns false with errno set if the file cannot be
 * read. */
static bool add_hash(const char *path, const char *also, struct text *out)
{
    size_t size;
    char *bytes = text_read_file(path, max_bytes, &size);
    if (!bytes)
        return false;
    text_add(out, "%016" PRIx64, XXH3_64bits(bytes, size) ^ XXH3_64bits(also, strlen(also)));
    mem_free(bytes);
    return true;
}

/* Error function of glob(3): a folder that cannot be listed is an error, unless it does not exist. */
static int is_unreadable(const char *path, int error)
{
    (void)path;
    errno = error;
    return error != ENOENT;
}

/* Returns true if a file is the model of one of the plant's conversions. */
static bool is_model(const struct plant *plant, const char *path)
{
    struct stat file, model;
    if (stat(path, &file) != 0)
        return false;
    for (size_t i = 0; i < plant->conversion_count; i++)
        if (stat(plant->conversions[i].model, &model) == 0 && file.st_dev == model.st_dev && file.st_ino == model.st_ino)
            return true;
    return false;
}

/* Appends to `out` one hash of the names and contents of all files that match the glob(3) pattern `also`. Leaves out the models of
 * conversions: the hash must not depend on what the command writes. Returns false with errno set if no file matches, or a file or folder
 * cannot be read. */
static bool add_matching(const struct plant *plant, const char *also, struct text *out)
{
    glob_t found = { 0 };
    struct text all = { 0 };
    int status = glob(also, GLOB_MARK | GLOB_BRACE, is_unreadable, &found), error = status == GLOB_NOMATCH ? ENOENT : errno;
    bool good = status == 0, has_folder = false;
    for (size_t i = 0; good && i < found.gl_pathc; i++) {
        const char *path = found.gl_pathv[i];
        bool is_folder = path[strlen(path) - 1] == '/';
        has_folder = has_folder || is_folder;
        good = is_folder || is_model(plant, path) || add_hash(path, path, &all);
        error = errno;
    }
    if (good && !all.at) {
        good = false;
        error = has_folder ? EISDIR : ENOENT;
    }
    if (good)
        text_add(out, "%016" PRIx64, XXH3_64bits(all.at, strlen(all.at)));
    text_finish(&all);
    globfree(&found);
    errno = error;
    return good;
}

static bool is_made(const json_t *made, const struct plant_conversion *how, const char *input_hash)
{
    const json_t *entry = json_object_get(made, how->model);
    const char *from = json_string_value(json_object_get(entry, "from")), *to = json_string_value(json_object_get(entry, "model"));
    struct text hash = { 0 };
    bool same = from && to && !strcmp(from, input_hash) && add_hash(how->model, "", &hash) && !strcmp(to, hash.at);
    text_finish(&hash);
    return same;
}

/* Runs the plant file's command that generates a model, in a temporary folder next to the model, and replaces the model only if
 * the command succeeds. */
static bool make(const struct plant_conversion *how, char why[CHILD_WHY_BYTES])
{
    struct work_folder work;
    struct model_header header;
    struct text said = { 0 };
    char *folder = mem_strdup(how->model), *slash = strrchr(folder, '/');
    if (slash)
        *slash = 0;
    int status = work_folder_begin(&work, slash ? folder : ".");
    mem_free(folder);
    if (status != 0) {
        snprintf(why, CHILD_WHY_BYTES, "%s", strerror(-status));
        return false;
    }
    char *output = mem_printf("%s/output.glb", work.path), *input = realpath(how->from, NULL);
    const char *const argv[] = { "/bin/sh", "-c", how->command, "convert", input ? input : how->from, output, NULL };
    struct child_paths paths = { 0 };
    child_paths_add_command(&paths, how->command);
    child_paths_add_folder_of(&paths, input, CONFINE_READ);
    child_paths_add(&paths, work.path, CONFINE_WRITE);
    const struct child_params child = { .argv = argv,
                                        .name = "the command",
                                        .folder = work.path,
                                        .timeout_s = (int)how->timeout_s,
                                        .memory_bytes = memory_bytes,
                                        .timeout_option = "timeout_s",
                                        .role = CONFINE_COMMAND,
                                        .paths = paths.at,
                                        .path_count = paths.count };
    bool good = child_run(&child, &said, why);
    child_paths_finish(&paths);
    if (good && !model_header_read(&header, output, why, CHILD_WHY_BYTES)) {
        char reason[CHILD_WHY_BYTES];
        snprintf(reason, sizeof(reason), "%.300s", why);
        snprintf(why, CHILD_WHY_BYTES, "its output ($2): %.300s", reason);
        good = false;
    } else if (good) {
        model_header_finish(&header);
        good = rename(output, how->model) == 0;
        if (!good)
            snprintf(why, CHILD_WHY_BYTES, "%s", strerror(errno));
    }
    text_finish(&said);
    mem_free(output);
    free(input);
    work_folder_end(&work, true);
    return good;
}

static bool convert_one(const struct plant *plant, const struct plant_conversion *how, json_t *made, FILE *progress, struct diag *diag)
{
    char why[CHILD_WHY_BYTES];
    struct text from = { 0 }, to = { 0 };
    const char *unread = !add_hash(how->from, how->command, &from)             ? how->from
                         : how->also && !add_matching(plant, how->also, &from) ? how->also
                                                                               : NULL;
    bool good = !unread;
    if (unread) {
        diag_error(diag, plant->files.path, how->line, 0, "convert: '%s' cannot be read: %s", unread, strerror(errno));
    } else if (!is_made(made, how, from.at)) {
        fprintf(progress, "plantcast-prep: creating %s from %s\n", how->model, how->from);
        good = make(how, why) && add_hash(how->model, "", &to);
        if (good)
            json_object_set_new(made, how->model, json_pack("{s:s,s:s}", "from", from.at, "model", to.at));
        else
            diag_error(diag, plant->files.path, how->line, 0, "convert: the model '%s' could not be created: %s", how->model, why);
    }
    text_finish(&from);
    text_finish(&to);
    return good;
}

bool convert_run(const struct plant *plant, const char *folder, FILE *progress, struct diag *diag)
{
    if (plant->conversion_count == 0)
        return true;
    char *path = mem_printf("%s/conversions.json", folder);
    json_t *made = json_load_file(path, 0, NULL);
    bool good = true;
    if (!json_is_object(made)) { /* the record of the last run is missing or damaged: generate all models */
        json_decref(made);
        made = json_object();
    }
    json_t *before = json_deep_copy(made);
    for (size_t i = 0; i < plant->conversion_count && good; i++)
        good = convert_one(plant, &plant->conversions[i], made, progress, diag);
    if (!json_equal(before, made)) {
        mkdir(folder, 0777);
        char *text = json_text(json_incref(made), 0);
        int status = atomic_file_put(path, text, strlen(text));
        if (status != 0)
            diag_error(diag, plant->files.path, 0, 0, "'%s' cannot be written: %s", path, strerror(-status));
        good = good && status == 0;
        mem_free(text);
    }
    json_decref(before);
    json_decref(made);
    mem_free(path);
    return good;
}
