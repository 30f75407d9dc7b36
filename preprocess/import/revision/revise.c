/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Implements revise() and revise_undo(): plans how new models change a plant's files, checks the new plant file by loading it in a
 * temporary folder, and replaces the files. */
#include "preprocess/import/revision/revise.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "plant/plant_folder.h"
#include "plant/recipe.h"
#include "preprocess/import/import_fail.h"
#include "preprocess/import/revision/revision.h"
#include "preprocess/import/revision/revision_files.h"
#include "preprocess/match/decisions.h"
#include "preprocess/match/file_set.h"
#include "preprocess/match/plant_trial.h"
#include "preprocess/report/text_table.h"

/* MAX_OWN_FILES: maximum number of files besides the models that a revision replaces: review.csv, tag list, matches.csv,
   plant.yaml */
enum { ROWS_PRINTED = 40, MAX_OWN_FILES = 4 };

static const char program[] = "plantcast import";
static const char *const kinds[] = { [REVISION_ASSET] = "asset", [REVISION_NODE] = "node", [REVISION_TAG] = "tag" };
static const size_t max_text_bytes = (size_t)64 << 20;

struct revising {
    const struct revise_params *params;
    struct plant *plant;
    char *plant_path, *plant_text, *tags_text, *matches_text;
    char *tags_name; /* name of the tag list in the plant's folder, or its path if it lies elsewhere */
    struct revision_model *models;
    size_t model_count;
    struct revision revision;
    struct text review;
    struct revision_file *files;
    size_t file_count;
};

/* --- reading ------------------------------------------------------------------------------------------------------------------ */

/* Reads a text file. Returns NULL if it does not exist, or on an error; the latter sets *status to 1. */
static char *read_text(const char *path, int *status)
{
    size_t bytes;
    char *text = text_read_file(path, max_text_bytes, &bytes);
    if (!text && errno != ENOENT)
        *status = import_fail(path, strerror(errno));
    return text;
}

/* Finds the tag list, following a symlink. Returns the exit status: 1 after printing an error if the list is in another folder
 * that is not writable. */
static int find_tags(struct revising *r)
{
    char folder[PATH_MAX], path[PATH_MAX];
    if (!realpath(r->params->folder, folder) || !realpath(r->plant->files.tags_path, path))
        return import_fail(r->plant->files.tags_path, strerror(errno));
    char *slash = strrchr(path, '/');
    *slash = 0;
    bool beside = !strcmp(folder, path);
    if (!beside && access(*path ? path : "/", W_OK | X_OK) != 0)
        return import_fail(r->plant->files.tags_path, "the folder of this tag list is not writable");
    *slash = '/';
    r->tags_name = mem_strdup(beside ? slash + 1 : path);
    return 0;
}

static int read_plant(struct revising *r)
{
    int status = 0;
    char *matches = mem_printf("%s/matches.csv", r->params->folder);
    r->plant_path = mem_printf("%s/plant.yaml", r->params->folder);
    r->plant = plant_load_or_print(r->plant_path);
    if (r->plant) {
        r->plant_text = read_text(r->plant_path, &status);
        r->tags_text = r->plant->files.tags_path ? read_text(r->plant->files.tags_path, &status) : NULL;
        if (r->tags_text && status == 0)
            status = find_tags(r);
        r->matches_text = read_text(matches, &status);
    }
    mem_free(matches);
    return r->plant ? status : 1;
}

/* Collects the models that differ from the copies in the plant folder. */
static void take_models(struct revising *r)
{
    r->models = mem_array(r->params->count, sizeof(*r->models));
    for (size_t i = 0; i < r->params->count; i++) {
        uint64_t hashes[2] = { 0, 1 };
        char *before = mem_printf("%s/%s", r->params->folder, r->params->models[i].file),
             *after = mem_printf("%s/%zu.glb", r->params->work, i);
        if (access(before, F_OK) != 0) {
            mem_free(before);
            before = NULL;
        }
        if (before && plant_model_hash(before, &hashes[0]) && plant_model_hash(after, &hashes[1]) && hashes[0] == hashes[1]) {
            printf("%s: unchanged\n", before);
            mem_free(before);
            mem_free(after);
            continue;
        }
        r->models[r->model_count++] = (struct revision_model){ before, after, &r->params->models[i] };
    }
}

/* --- the review ----------------------------------------------------------------------------------------------------------------- */

static void count_rows(const struct revision *revision)
{
    static const char *const changes[] = { "added", "removed", "renamed", "moved", "changed", "node lost", "place lost", "equipment lost" };
    for (int kind = REVISION_ASSET; kind <= REVISION_TAG; kind++) {
        bool any = false;
        for (size_t c = 0; c < sizeof(changes) / sizeof(changes[0]); c++) {
            size_t count = 0;
            for (size_t i = 0; i < revision->row_count; i++)
                count += (int)revision->rows[i].kind == kind && !strcmp(revision->rows[i].change, changes[c]);
            if (count == 0)
                continue;
            if (any)
                printf(", %zu %s", count, changes[c]);
            else
                printf("%ss: %zu %s", kinds[kind], count, changes[c]);
            any = true;
        }
        if (any)
            printf("\n");
    }
}

static void print_review(const struct revision *revision)
{
    static const struct text_table_column columns[] = { { "what", false }, { "change", false }, { "name", false }, { "detail", false } };
    struct text_table table = { .columns = columns, .column_count = 4 };
    for (size_t i = 0; i < revision->row_count; i++) {
        const struct revision_row *row = &revision->rows[i];
        text_table_add(&table, "%s", kinds[row->kind]);
        text_table_add(&table, "%s", row->change);
        text_table_add(&table, "%s", row->name);
        text_table_add(&table, "%s", row->detail);
    }
    if (revision->row_count > 0)
        text_table_print(&table, ROWS_PRINTED, stdout);
    text_table_finish(&table);
    count_rows(revision);
}

static void write_review(struct revising *r)
{
    text_add(&r->review, "What,Change,Name,Detail\n");
    for (size_t i = 0; i < r->revision.row_count; i++) {
        const struct revision_row *row = &r->revision.rows[i];
        text_add(&r->review, "%s,%s,", kinds[row->kind], row->change);
        text_add_cell(&r->review, row->name, ",\"\r\n");
        text_add(&r->review, ",");
        text_add_cell(&r->review, row->detail, ",\"\r\n");
        text_add(&r->review, "\n");
    }
}

/* --- the files ------------------------------------------------------------------------------------------------------------------ */

/* Adds a text file to the transaction that replaces the plant's files. text: new text; NULL: unchanged. before: text that the
 * file must still have when it is replaced; NULL: not checked, because only this program writes the file. */
static int add_text(struct revising *r, const char *name, const char *text, const char *before)
{
    struct revision_file *file = &r->files[r->file_count++];
    *file = (struct revision_file){ name, text ? mem_printf("%s/text%zu", r->params->work, r->file_count) : NULL, before };
    int status = text ? atomic_file_put(file->made, text, strlen(text)) : 0;
    return status == 0 ? 0 : import_fail(name, strerror(-status));
}

static const char *if_other(const char *text, const char *before)
{
    return text && strcmp(text, before) != 0 ? text : NULL;
}

/* Replaces the plant's files, plant.yaml last, so that the daemon can load the folder even between two replacements. */
static int apply(struct revising *r)
{
    r->files = mem_array(r->model_count + MAX_OWN_FILES, sizeof(*r->files));
    for (; r->file_count < r->model_count; r->file_count++)
        r->files[r->file_count] =
            (struct revision_file){ r->models[r->file_count].draft->file, mem_strdup(r->models[r->file_count].after), NULL };
    int status = add_text(r, "review.csv", r->review.at, NULL);
    if (status == 0 && r->tags_text)
        status = add_text(r, r->tags_name, if_other(r->revision.tags_text, r->tags_text), r->tags_text);
    if (status == 0 && r->matches_text) {
        char *matches = decisions_without(r->matches_text, r->revision.lost, r->revision.lost_count);
        status = add_text(r, "matches.csv", if_other(matches, r->matches_text), r->matches_text);
        mem_free(matches);
    }
    if (status == 0)
        status = add_text(r, "plant.yaml", if_other(r->revision.plant_text, r->plant_text), r->plant_text);
    return status == 0 ? revision_files_replace(r->params->folder, r->params->work, r->files, r->file_count) : status;
}

static int plan(struct revising *r)
{
    char why[MODEL_WHY_BYTES];
    const struct revision_input input = { .plant = r->plant,
                                          .plant_text = r->plant_text,
                                          .tags_text = r->tags_text,
                                          .models = r->models,
                                          .model_count = r->model_count };
    if (!revision_plan(&r->revision, &input, why)) {
        fprintf(stderr, "%s: %s\n", program, why);
        return 1;
    }
    struct plant *trial = plant_trial_load(r->plant, r->revision.plant_text,
                                           r->revision.tags_text ? r->revision.tags_text : r->tags_text, program);
    bool good = trial != NULL;
    plant_destroy(&trial);
    return good ? 0 : 1;
}

static void finish(struct revising *r)
{
    for (size_t i = 0; i < r->model_count; i++) {
        mem_free(r->models[i].before);
        mem_free(r->models[i].after);
    }
    for (size_t i = 0; i < r->file_count; i++)
        mem_free(r->files[i].made);
    mem_free(r->models);
    mem_free(r->files);
    text_finish(&r->review);
    revision_finish(&r->revision);
    plant_destroy(&r->plant);
    mem_free(r->plant_path);
    mem_free(r->plant_text);
    mem_free(r->tags_text);
    mem_free(r->tags_name);
    mem_free(r->matches_text);
}

int revise(const struct revise_params *params)
{
    struct revising r = { .params = params };
    int status = read_plant(&r);
    if (status == 0)
        take_models(&r);
    if (status == 0 && r.model_count == 0) {
        printf("%s: unchanged\n", r.plant_path);
    } else if (status == 0) {
        status = plan(&r);
        if (status == 0) {
            print_review(&r.revision);
            write_review(&r);
        }
        if (status == 0 && !params->dry_run) {
            status = apply(&r);
            if (status == 0)
                printf("%s/review.csv: %zu rows\n%s: %s; to undo: plantcast import --undo -o %s\n", params->folder,
                       r.revision.row_count, r.plant_path, strcmp(r.plant_text, r.revision.plant_text) ? "written" : "unchanged",
                       params->folder);
        }
    }
    finish(&r);
    return status;
}

int revise_undo(const char *folder, bool forced, int lent)
{
    struct text changed = { 0 }, done = { 0 };
    char *why = NULL;
    int lock = file_set_lock(&(struct plant_folder_params){ .folder = folder, .lent = lent }, &why), status = lock < 0 ? lock : 0;
    if (status == 0) {
        status = revision_files_undo(folder, forced, &changed, &done);
        close(lock);
    }
    if (status == -EBUSY)
        fprintf(stderr,
                "%s: %s: files were changed since the import: %s; --force undoes the import anyway and keeps these files as NAME.undone\n",
                program, folder, changed.at);
    else if (status != 0)
        import_fail(folder, why ? why : status == -ENOENT ? "this folder has no import to undo" : strerror(-status));
    else
        printf("%s: restored to the state before the last import: %s\n", folder, done.at ? done.at : "");
    text_finish(&changed);
    text_finish(&done);
    mem_free(why);
    return status == 0 ? 0 : 1;
}
