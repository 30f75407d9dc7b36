/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The programs of an import, one after the other, as somebody would run them by hand. */
#include "import_job.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/atomic_file.h"
#include "base/mem.h"
#include "base/text.h"
#include "importing/export_folder.h"
#include "sibling.h"

enum { FILES = 3, MOST_ARGUMENTS = 300 };
static const size_t max_bytes = (size_t)256 << 20;

struct import_job {
    struct import_job_params params;
    char *paths[FILES], *texts[FILES]; /* a text is NULL where there was no file */
};

struct arguments {
    const char *at[MOST_ARGUMENTS + 1]; /* ends in NULL */
    char *own[MOST_ARGUMENTS];          /* those that are to be freed */
    size_t count, owned;
};

struct import_job *import_job_begin(const struct import_job_params *params)
{
    struct import_job *job = mem_new(sizeof(*job));
    const char *const paths[FILES] = { params->plant_path, params->tags_path, plant_import_matches(params->import) };
    job->params = *params;
    for (int i = 0; i < FILES; i++) {
        size_t bytes;
        job->paths[i] = mem_strdup(paths[i]);
        job->texts[i] = text_read_file(paths[i], max_bytes, &bytes);
    }
    return job;
}

void import_job_end(struct import_job **pointer)
{
    for (int i = 0; i < FILES; i++) {
        mem_free((*pointer)->paths[i]);
        mem_free((*pointer)->texts[i]);
    }
    mem_free(*pointer);
    *pointer = NULL;
}

static void add(struct arguments *list, const char *argument)
{
    if (list->count < MOST_ARGUMENTS)
        list->at[list->count++] = argument;
}

/* A file of the exports. What is a link to a file is that file: what it needs lies beside that one. */
static void add_export(struct arguments *list, const struct import_job *job, const char *name)
{
    char real[PATH_MAX], *path = mem_printf("%s/%s", plant_import_exports(job->params.import), name);
    if (list->owned < MOST_ARGUMENTS) {
        list->own[list->owned] = realpath(path, real) ? mem_strdup(real) : mem_strdup(path);
        add(list, list->own[list->owned++]);
    }
    mem_free(path);
}

static void say(void *arg, const char *text)
{
    plant_import_say(((struct import_job *)arg)->params.import, text);
}

static bool stop(void *arg)
{
    const struct import_job *job = arg;
    return job->params.stop(job->params.arg);
}

/* The report of preparing is for who adjusts it. */
static void say_nothing(void *arg, const char *text)
{
    (void)arg;
    (void)text;
}

static char *run(struct import_job *job, struct arguments *list, enum import_phase phase)
{
    plant_import_set_phase(job->params.import, phase);
    list->at[list->count] = NULL;
    char *why = sibling_run(
        &(struct sibling_params){ .arguments = list->at, .stop = stop, .say = phase == IMPORT_PREPARING ? say_nothing : say, .arg = job });
    for (size_t i = 0; i < list->owned; i++)
        mem_free(list->own[i]);
    return why;
}

static char *read_models(struct import_job *job, const struct import_order *order, const struct export_list *exports, const char *folder)
{
    struct arguments list = { 0 };
    size_t models = 0;
    add(&list, "plantcast-import");
    if (order->anew)
        add(&list, "--anew");
    add(&list, "-o");
    add(&list, folder);
    if (*order->units) {
        add(&list, "--units");
        add(&list, order->units);
    }
    if (*order->up) {
        add(&list, "--up");
        add(&list, order->up);
    }
    for (size_t i = 0; i < exports->count; i++)
        if (exports->at[i].kind == EXPORT_MODEL) {
            add_export(&list, job, exports->at[i].name);
            models++;
        }
    return models > 0 ? run(job, &list, IMPORT_READING) : mem_strdup("there is no model yet");
}

static char *match_tags(struct import_job *job, const struct import_order *order, const struct export_list *exports)
{
    struct arguments list = { 0 };
    const char *tags = NULL;
    char *decisions = mem_printf("%s/%s", plant_import_exports(job->params.import), plant_import_decisions());
    for (size_t i = 0; i < exports->count; i++)
        if (exports->at[i].kind == EXPORT_TAGS)
            tags = exports->at[i].name;
    add(&list, "plantcast-match");
    if (order->decides) {
        add(&list, "--decide");
        add(&list, decisions);
    }
    add(&list, job->params.plant_path);
    char *why = NULL;
    if (tags) {
        add_export(&list, job, tags);
        why = run(job, &list, IMPORT_MATCHING);
    } else if (!order->models) {
        why = mem_strdup("there is no tag list yet");
    }
    mem_free(decisions);
    return why;
}

static char *prepare(struct import_job *job)
{
    struct arguments list = { 0 };
    add(&list, "plantcast-prep");
    add(&list, "-o");
    add(&list, job->params.prepared);
    add(&list, job->params.plant_path);
    return run(job, &list, IMPORT_PREPARING);
}

char *import_job_run(struct import_job *job, const struct import_order *order, char **remark)
{
    struct export_list exports = { 0 };
    const char *slash = strrchr(job->params.plant_path, '/');
    char *folder = slash ? mem_printf("%.*s", (int)(slash - job->params.plant_path), job->params.plant_path) : mem_strdup(".");
    export_folder_list(plant_import_exports(job->params.import), &exports);
    char *why = order->models ? read_models(job, order, &exports, folder) : NULL;
    *remark = why ? NULL : match_tags(job, order, &exports);
    if (*remark && (!order->models || stop(job))) {
        why = *remark;
        *remark = NULL;
    }
    if (!why)
        why = prepare(job);
    export_list_finish(&exports);
    mem_free(folder);
    return why;
}

void import_job_undo(struct import_job *job)
{
    for (int i = 0; i < FILES; i++)
        if (job->texts[i])
            atomic_file_put(job->paths[i], job->texts[i], strlen(job->texts[i]));
        else
            unlink(job->paths[i]);
}
