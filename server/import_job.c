/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs the programs of an import one after the other, in the way a user would run them from the command line. */
#include "import_job.h"

#include <inttypes.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "base/text/text.h"
#include "importing/export_folder.h"
#include "plant/plant_folder.h"
#include "helper_program.h"

/* OWN_MB: memory limit in MB of plantcast-import itself, excluding its child processes, which read the files */
enum { FILES = 3, OWN_MB = 512 };
static const size_t max_bytes = (size_t)256 << 20;

struct texts {
    char *at[FILES]; /* content of each file that an import changes (plant file, tag list, matches); NULL: the file does not exist */
};

struct import_job {
    struct import_job_params params;
    char *folder, *paths[FILES];
    /* contents of the plant file, tag list and matches at three times: before the import, after the models were read, and after the tags
       were matched */
    struct texts first, read, last;
    ino_t revision; /* inode of the newest revision folder before the import (find_revision()); 0: there was none */
    bool prepares;  /* true: plantcast-prep, which prepares the models, was started */
    bool undoes;    /* true: an undo is running; params.stop does not stop it */
};

struct arguments { /* zero-initialise */
    const char **at; /* array of the program's arguments; an element NULL ends it */
    char **own;      /* elements of `at` that were allocated for this list, which frees them */
    size_t count, capacity, owned, own_capacity;
};

static void remember(const struct import_job *job, struct texts *texts)
{
    for (int i = 0; i < FILES; i++) {
        size_t bytes;
        mem_free(texts->at[i]);
        texts->at[i] = text_read_file(job->paths[i], max_bytes, &bytes);
    }
}

static void forget(struct texts *texts)
{
    for (int i = 0; i < FILES; i++)
        mem_free(texts->at[i]);
}

/* Returns the inode of the revision folder, in which plantcast import keeps the previous files; 0: there is none. A new
   revision is created before the old one is removed, so its inode differs. */
static ino_t find_revision(const struct import_job *job, const char *name)
{
    struct stat st;
    char *path = mem_printf("%s/%s", job->folder, name);
    ino_t found = stat(path, &st) == 0 ? st.st_ino : 0;
    mem_free(path);
    return found;
}

struct import_job *import_job_begin(const struct import_job_params *params)
{
    struct import_job *job = mem_new(sizeof(*job));
    const char *const paths[FILES] = { params->plant_path, params->tags_path, plant_import_matches(params->import) };
    job->params = *params;
    job->folder = plant_folder_of(params->plant_path);
    for (int i = 0; i < FILES; i++)
        job->paths[i] = mem_strdup(paths[i]);
    job->revision = find_revision(job, ".revision");
    remember(job, &job->first);
    remember(job, &job->read);
    remember(job, &job->last);
    return job;
}

void import_job_end(struct import_job **pointer)
{
    struct import_job *job = *pointer;
    for (int i = 0; i < FILES; i++)
        mem_free(job->paths[i]);
    forget(&job->first);
    forget(&job->read);
    forget(&job->last);
    mem_free(job->folder);
    mem_free(job);
    *pointer = NULL;
}

static void add_argument(struct arguments *list, const char *argument)
{
    mem_grow(&list->at, &list->capacity, list->count + 2, sizeof(*list->at));
    list->at[list->count++] = argument;
    list->at[list->count] = NULL;
}

/* Adds an argument and takes ownership of the text (mem_free). */
static void add_own(struct arguments *list, char *argument)
{
    mem_grow(&list->own, &list->own_capacity, list->owned + 1, sizeof(*list->own));
    list->own[list->owned++] = argument;
    add_argument(list, argument);
}

static void arguments_finish(struct arguments *list)
{
    for (size_t i = 0; i < list->owned; i++)
        mem_free(list->own[i]);
    mem_free(list->own);
    mem_free(list->at);
}

/* Adds the path of an uploaded file to the program's arguments. A symlink is resolved, because the files to which a model
   refers are in the folder of the real file. */
static void add_export(struct arguments *list, const struct import_job *job, const char *name)
{
    char real[PATH_MAX], *path = mem_printf("%s/%s", plant_import_exports(job->params.import), name);
    add_own(list, mem_strdup(realpath(path, real) ? real : path));
    mem_free(path);
}

static void say(void *arg, const char *text)
{
    plant_import_say(((struct import_job *)arg)->params.import, text);
}

static bool stop(void *arg)
{
    const struct import_job *job = arg;
    return !job->undoes && job->params.stop(job->params.arg);
}

/* Callback for the output of plantcast-prep: discards it, because it only helps to tune preparation by hand. */
static void say_nothing(void *arg, const char *text)
{
    (void)arg;
    (void)text;
}

static struct helper_params params_of(struct import_job *job, enum import_phase phase)
{
    plant_import_set_phase(job->params.import, phase);
    return (struct helper_params){
        .stop = stop, .say = phase == IMPORT_PREPARING ? say_nothing : say, .arg = job, .log = job->params.log, .lent = job->params.lock
    };
}

static char *run_program(struct import_job *job, struct arguments *list, enum import_phase phase, char **remark)
{
    struct helper_params params = params_of(job, phase);
    params.arguments = list->at;
    params.remark = remark;
    params.memory_bytes = ((size_t)job->params.quotas->at[QUOTA_IMPORT_MB] + OWN_MB) << 20;
    params.memory_option = "--limit import-megabytes";
    return helper_run(&params);
}

static void add_limit(struct arguments *list, const char *option, int64_t limit)
{
    add_argument(list, option);
    add_own(list, mem_printf("%" PRId64, limit));
}

/* Adds options that limit each file-reading process; run() limits all processes together. */
static void add_limits(struct arguments *list, const struct import_job *job)
{
    add_limit(list, "--timeout", job->params.quotas->at[QUOTA_IMPORT_S]);
    add_limit(list, "--memory", job->params.quotas->at[QUOTA_IMPORT_MB]);
}

/* Adds the option that tells a program about this daemon's lock on the plant's folder, and passes the lock's descriptor. */
static void add_lent(struct arguments *list)
{
    add_argument(list, "--folder-lent");
    add_own(list, mem_printf("%d", HELPER_LENT));
}

static void add_option(struct arguments *list, const char *option, const char *value)
{
    if (*value) {
        add_argument(list, option);
        add_argument(list, value);
    }
}

/* Reads the models. Returns NULL on success, else an error message (free with mem_free()). If only some models could be read, *remark
   receives the names of the others (mem_free). */
static char *read_models(struct import_job *job, const struct import_order *order, const struct export_list *exports, char **remark)
{
    struct arguments list = { 0 };
    size_t models = 0;
    add_argument(&list, "plantcast-import");
    if (order->anew)
        add_argument(&list, "--anew");
    add_lent(&list);
    add_limits(&list, job);
    add_argument(&list, "-o");
    add_argument(&list, job->folder);
    add_option(&list, "--units", order->units);
    add_option(&list, "--mesh-units", order->mesh_units);
    add_option(&list, "--up", order->up);
    add_option(&list, "--report", plant_import_report(job->params.import));
    add_option(&list, "--encoding", order->encoding);
    for (size_t i = 0; i < exports->count; i++)
        if (exports->at[i].kind == EXPORT_MODEL) {
            add_export(&list, job, exports->at[i].name);
            models++;
        }
    char *why = models > 0 ? run_program(job, &list, IMPORT_READING, remark) : mem_strdup("no model has been uploaded yet");
    arguments_finish(&list);
    return why;
}

static void add_source(struct arguments *list, const struct import_source *source)
{
    add_argument(list, "--modbus");
    add_own(list, mem_printf("%s%s%s", source->host, *source->port ? ":" : "", source->port));
    add_option(list, "--unit", source->unit);
    add_option(list, "--byte-order", source->order);
    add_option(list, "--address-base", source->base);
}

/* Returns the file name of the tag list in the exports folder; NULL: there is none. */
static const char *find_tags(const struct export_list *exports)
{
    const char *tags = NULL;
    for (size_t i = 0; i < exports->count; i++)
        if (exports->at[i].kind == EXPORT_TAGS)
            tags = exports->at[i].name;
    return tags;
}

static char *match_tags(struct import_job *job, const struct import_order *order, const struct export_list *exports)
{
    struct arguments list = { 0 };
    const char *tags = find_tags(exports);
    char *decisions = mem_printf("%s/%s", plant_import_exports(job->params.import), plant_import_decisions());
    add_argument(&list, "plantcast-match");
    if (order->decides) {
        add_argument(&list, "--decide");
        add_argument(&list, decisions);
    }
    add_lent(&list);
    add_limits(&list, job);
    add_option(&list, "--encoding", order->encoding);
    if (*order->source.host)
        add_source(&list, &order->source);
    add_argument(&list, job->params.plant_path);
    char *why = NULL;
    if (tags) {
        add_export(&list, job, tags);
        why = run_program(job, &list, IMPORT_MATCHING, NULL);
    } else if (!order->models) {
        why = mem_strdup("no tag list has been uploaded yet");
    }
    arguments_finish(&list);
    mem_free(decisions);
    return why;
}

static char *prepare(struct import_job *job)
{
    struct helper_params params = params_of(job, IMPORT_PREPARING);
    job->prepares = true;
    return helper_prepare(&params, job->params.prepared, job->params.plant_path, job->params.quotas);
}

char *import_job_run(struct import_job *job, const struct import_order *order, char **remark)
{
    struct export_list exports = { 0 };
    export_folder_list(plant_import_exports(job->params.import), &exports);
    char *why = NULL, *unread = NULL;
    /* A new plant file without a tag list is refused if the user gave a data source: only plantcast match, which needs a tag
       list, writes the data source into the new file. */
    if (order->anew && *order->source.host && !find_tags(&exports))
        why = mem_printf("upload a tag list first: without one, the plant would lose its data source %s", order->source.host);
    else if (order->models)
        why = read_models(job, order, &exports, &unread);
    remember(job, &job->read);
    remember(job, &job->last);
    *remark = why ? NULL : match_tags(job, order, &exports);
    remember(job, &job->last);
    if (*remark && (!order->models || stop(job))) {
        why = *remark;
        *remark = NULL;
    }
    if (!why && unread) {
        char *both = *remark ? mem_printf("%s; %s", unread, *remark) : mem_strdup(unread);
        mem_free(*remark);
        *remark = both;
    }
    mem_free(unread);
    if (!why)
        why = prepare(job);
    export_list_finish(&exports);
    return why;
}

static bool same(const char *a, const char *b)
{
    return a && b ? !strcmp(a, b) : a == b;
}

/* Restores the earlier contents of the files. Skips files that another program has changed since the programs of this import
   wrote them. */
static void put_texts(const struct import_job *job, const struct texts *texts)
{
    struct texts now = { 0 };
    remember(job, &now);
    for (int i = 0; i < FILES; i++)
        if (same(now.at[i], job->last.at[i]) && !same(now.at[i], texts->at[i])) {
            if (texts->at[i])
                atomic_file_put(job->paths[i], texts->at[i], strlen(texts->at[i]));
            else
                unlink(job->paths[i]);
        }
    forget(&now);
}

/* Returns true if a revision (folder with the previous files) was written since the beginning. The revision counts even if its
   program was killed while replacing files: the next program completes the replacement. */
static bool has_revised(const struct import_job *job)
{
    ino_t now = find_revision(job, ".revision");
    return (now != 0 && now != job->revision) || find_revision(job, ".revision.pending") != 0;
}

char *import_job_undo(struct import_job *job)
{
    struct arguments list = { 0 };
    if (!has_revised(job)) {
        put_texts(job, &job->first);
        return NULL;
    }
    put_texts(job, &job->read);
    add_argument(&list, "plantcast-import");
    add_argument(&list, "--undo");
    add_argument(&list, "--force");
    add_lent(&list);
    add_argument(&list, "-o");
    add_argument(&list, job->folder);
    job->undoes = true;
    char *why = run_program(job, &list, IMPORT_READING, NULL);
    arguments_finish(&list);
    job->undoes = false;
    return why;
}

bool import_job_prepares(const struct import_job *job)
{
    return job->prepares;
}
