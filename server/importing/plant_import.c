/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keeps the state and the messages of the import that an engineer has ordered on the page. */
#include "importing/plant_import.h"

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "base/text/json_text.h"
#include "base/text/text.h"
#include "base/text/utf8.h"
#include "importing/export_folder.h"
#include "plant/plant_folder.h"

enum { MAX_OUTPUT_BYTES = 64 * 1024 };

struct plant_import {
    /* exports: folder of uploaded files; matches: matches.csv; report: report of `plantcast import`; choice: file that stores
       the chosen units, axis and encoding, so that they survive a restart of the daemon */
    char *exports, *matches, *report, *choice;
    pthread_mutex_t lock;
    /* --- below: under `lock` */
    struct import_order order; /* the import order in progress or, if there is none, the last one */
    /* the last successful import order that read models: the units, axis and encoding of the present models are those of this
       order */
    struct import_order read;
    bool ordered, busy, cancelled;
    enum import_phase phase;
    unsigned number; /* number of import orders since the daemon's start; increases with each order */
    struct text said;
    char *why; /* reason why the last import order failed; NULL: it succeeded */
};

/* Reads the stored choice of units, axis and encoding from its file, with the text "UNITS/UP/ENCODING/MESH_UNITS"; trailing
   parts may be missing. */
static void read_choice(struct plant_import *import)
{
    struct import_order order = { 0 };
    const struct {
        char *at;
        size_t size;
    } parts[] = { { order.units, sizeof(order.units) },
                  { order.up, sizeof(order.up) },
                  { order.encoding, sizeof(order.encoding) },
                  { order.mesh_units, sizeof(order.mesh_units) } };
    size_t bytes;
    char *text = text_read_file(import->choice, 100, &bytes), *rest = text, *part;
    bool fits = text != NULL;
    for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]) && (part = strsep(&rest, "/")); i++)
        fits = snprintf(parts[i].at, parts[i].size, "%s", part) < (int)parts[i].size && fits;
    if (fits && import_order_good(&order))
        import->read = order;
    mem_free(text);
}

struct plant_import *plant_import_create(const char *plant_path)
{
    struct plant_import *import = mem_new(sizeof(*import));
    char *folder = plant_folder_of(plant_path);
    import->exports = export_folder_of(folder);
    import->matches = mem_printf("%s/matches.csv", folder);
    import->choice = mem_printf("%s/%s", import->exports, export_folder_choice());
    import->report = mem_printf("%s/%s", import->exports, export_folder_report());
    mem_free(folder);
    pthread_mutex_init(&import->lock, NULL);
    if (mkdir(import->exports, 0777) != 0 && errno != EEXIST) {
        int cause = errno;
        plant_import_destroy(&import);
        errno = cause;
        return NULL;
    }
    export_folder_sweep(import->exports);
    read_choice(import);
    return import;
}

void plant_import_destroy(struct plant_import **pointer)
{
    struct plant_import *import = *pointer;
    if (!import)
        return;
    pthread_mutex_destroy(&import->lock);
    text_finish(&import->said);
    mem_free(import->why);
    mem_free(import->matches);
    mem_free(import->choice);
    mem_free(import->report);
    mem_free(import->exports);
    mem_free(import);
    *pointer = NULL;
}

/* --- functions that the event loop calls -------------------------------------------------------------------------------- */

const char *plant_import_exports(const struct plant_import *import)
{
    return import->exports;
}

const char *plant_import_matches(const struct plant_import *import)
{
    return import->matches;
}

const char *plant_import_report(const struct plant_import *import)
{
    return import->report;
}

const char *plant_import_decisions(void)
{
    return ".decisions.csv";
}

static bool is_one_of(const char *word, const char *const *words)
{
    while (*words && strcmp(*words, word) != 0)
        words++;
    return *words != NULL;
}

bool import_order_good(const struct import_order *order)
{
    static const char *const units[] = { "", "m", "mm", "cm", "in", "ft", NULL }, *const axes[] = { "", "y", "z", NULL };
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
    bool named = order->encoding[strspn(order->encoding, letters)] == 0 && *order->encoding != '-';
    return named && is_one_of(order->units, units) && is_one_of(order->mesh_units, units) && is_one_of(order->up, axes) &&
           (!*order->source.host || import_source_good(&order->source));
}

bool plant_import_order(struct plant_import *import, const struct import_order *order)
{
    pthread_mutex_lock(&import->lock);
    bool taken = !import->busy;
    if (taken) {
        import->order = *order;
        /* An order that only applies match decisions or sets the data source does not state the tag list's encoding: keeps that
           of the last import. */
        if (order->decides || *order->source.host)
            strcpy(import->order.encoding, import->read.encoding);
        import->ordered = import->busy = true;
        import->cancelled = false;
        import->phase = order->models ? IMPORT_READING : IMPORT_MATCHING;
        import->number++;
        text_finish(&import->said);
        mem_free(import->why);
        import->why = NULL;
    }
    pthread_mutex_unlock(&import->lock);
    return taken;
}

void plant_import_cancel(struct plant_import *import)
{
    pthread_mutex_lock(&import->lock);
    import->cancelled = import->busy;
    pthread_mutex_unlock(&import->lock);
}

bool plant_import_busy(struct plant_import *import)
{
    pthread_mutex_lock(&import->lock);
    bool busy = import->busy;
    pthread_mutex_unlock(&import->lock);
    return busy;
}

static json_t *files(const char *folder)
{
    static const char *const kinds[] = { "model", "beside", "tags" };
    struct export_list list = { 0 };
    json_t *array = json_array();
    export_folder_list(folder, &list);
    for (size_t i = 0; i < list.count; i++)
        json_array_append_new(array, json_pack("{s:s,s:s,s:I}", "name", list.at[i].name, "kind", kinds[list.at[i].kind], "bytes",
                                               (json_int_t)list.at[i].bytes));
    export_list_finish(&list);
    return array;
}

char *plant_import_text(struct plant_import *import, const struct import_source *source)
{
    static const char *const phases[] = { "idle", "reading", "matching", "preparing", "loading" };
    json_t *array = files(import->exports);
    pthread_mutex_lock(&import->lock);
    json_t *object = json_pack("{s:s,s:i,s:s,s:s?,s:s,s:s,s:s,s:s,s:o}", "phase", phases[import->phase], "number", (int)import->number,
                               "said", import->said.at ? import->said.at : "", "failed", import->why, "units", import->read.units, "up",
                               import->read.up, "encoding", import->read.encoding, "mesh_units", import->read.mesh_units, "files", array);
    pthread_mutex_unlock(&import->lock);
    json_object_set_new(object, "source", *source->host ? import_source_json(source) : json_null());
    return json_text(object, 0);
}

/* --- functions that the reload thread calls ----------------------------------------------------------------------------- */

/* Appends the output of an import program to `out`. Names of files and tags may contain arbitrary bytes, so each invalid UTF-8
   byte and each control character except newline becomes '?'. */
static void add_printable(struct text *out, const char *text)
{
    for (size_t left = strlen(text), bytes; left > 0; text += bytes, left -= bytes) {
        bytes = utf8_length(text, left);
        bool shown = bytes > 0 && ((unsigned char)*text >= ' ' || *text == '\n') && *text != 0x7f;
        bytes = bytes > 0 ? bytes : 1;
        text_add_bytes(out, shown ? text : "?", shown ? bytes : 1);
    }
}

bool plant_import_next(struct plant_import *import, struct import_order *order)
{
    pthread_mutex_lock(&import->lock);
    bool ordered = import->ordered;
    import->ordered = false;
    *order = import->order;
    pthread_mutex_unlock(&import->lock);
    return ordered;
}

void plant_import_set_phase(struct plant_import *import, enum import_phase phase)
{
    pthread_mutex_lock(&import->lock);
    import->phase = phase;
    pthread_mutex_unlock(&import->lock);
}

void plant_import_say(struct plant_import *import, const char *text)
{
    pthread_mutex_lock(&import->lock);
    if (import->said.length < MAX_OUTPUT_BYTES)
        add_printable(&import->said, text);
    pthread_mutex_unlock(&import->lock);
}

bool plant_import_cancelled(struct plant_import *import)
{
    pthread_mutex_lock(&import->lock);
    bool cancelled = import->cancelled;
    pthread_mutex_unlock(&import->lock);
    return cancelled;
}

void plant_import_end(struct plant_import *import, bool in_force, const char *why)
{
    struct text line = { 0 };
    if (why)
        add_printable(&line, why);
    pthread_mutex_lock(&import->lock);
    if (in_force && import->order.models)
        import->read = import->order;
    if (in_force)
        strcpy(import->read.encoding, import->order.encoding);
    char *choice = mem_printf("%s/%s/%s/%s", import->read.units, import->read.up, import->read.encoding, import->read.mesh_units);
    import->phase = IMPORT_IDLE;
    import->busy = false;
    mem_free(import->why);
    import->why = line.at;
    pthread_mutex_unlock(&import->lock);
    /* ignores errors: if the file cannot be written, a restart of the daemon merely forgets the chosen units, axis and encoding */
    atomic_file_put(import->choice, choice, strlen(choice));
    mem_free(choice);
}
