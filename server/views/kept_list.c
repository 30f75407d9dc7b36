/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A list of users' entries, such as notes or named views, that is stored in a file of its own. Every change writes the whole
   file, because the lists are short. */
#include "views/kept_list.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"

enum { VERSION = 1 }; /* version of the files' format */

size_t kept_list_find(const json_t *list, const char *id)
{
    size_t i = 0;
    while (i < json_array_size(list) && strcmp(json_string_value(json_object_get(json_array_get(list, i), "id")), id) != 0)
        i++;
    return i;
}

static bool good_members(const struct kept_list_kind *kind, const json_t *entry)
{
    for (const char *const *name = kind->texts; *name; name++)
        if (!json_is_string(json_object_get(entry, *name)))
            return false;
    for (const char *const *name = kind->integers; *name; name++)
        if (!json_is_integer(json_object_get(entry, *name)))
            return false;
    return kind->good(entry);
}

static bool good_list(const struct kept_list_kind *kind, const json_t *list)
{
    if (!json_is_array(list) || json_array_size(list) > kind->most)
        return false;
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *entry = json_array_get(list, i);
        if (!good_members(kind, entry) || kept_list_find(list, json_string_value(json_object_get(entry, "id"))) != i)
            return false;
    }
    return true;
}

static void read_file(struct kept_list *kept)
{
    json_error_t error = { 0 };
    errno = 0;
    json_t *file = json_load_file(kept->path, JSON_REJECT_DUPLICATES, &error);
    json_t *list = json_object_get(file, kept->kind->key), *version = json_object_get(file, "version");
    bool newer = json_integer_value(version) > VERSION;
    kept->unreadable = newer || !good_list(kept->kind, list);
    if (newer)
        log_err(kept->log,
                "%s: version %lld of this file was written by a newer Plantcast; this program supports version %d, and neither uses nor "
                "changes the file. Install the newer Plantcast again; or stop the daemon, run `mv %s ANOTHER_FOLDER`, and start the daemon",
                kept->path, (long long)json_integer_value(version), VERSION, kept->path);
    else if (!file && error.line < 0)
        log_err(kept->log, "%s: cannot be read: %s; the file is ignored and not changed", kept->path, strerror(errno));
    else if (kept->unreadable)
        log_err(kept->log, "%s:%d: %s%s%s%s; the file is ignored and not changed", kept->path, file ? 1 : error.line,
                file ? "not a list of " : error.text, file ? kept->kind->key : "", file ? " with " : "", file ? kept->kind->members : "");
    else
        json_array_extend(kept->list, list);
    json_decref(file);
}

void kept_list_open(struct kept_list *kept, struct log *log, const char *folder, const struct kept_list_kind *kind,
                    struct file_writer *writer)
{
    *kept = (struct kept_list){ .log = log, .kind = kind, .folder = folder, .writer = writer, .list = json_array() };
    kept->path = folder ? mem_printf("%s/%s", folder, kind->file) : NULL;
    if (kept->path && access(kept->path, F_OK) == 0)
        read_file(kept);
    kept->number = json_array_size(kept->list) > 0;
}

void kept_list_close(struct kept_list *kept)
{
    file_writer_forget(kept->writer, kept);
    json_decref(kept->next);
    json_decref(kept->list);
    mem_free(kept->path);
}

json_t *kept_list_newest(const struct kept_list *kept)
{
    return kept->next ? kept->next : kept->list;
}

const char *kept_list_unread_file(const struct kept_list *kept)
{
    return kept->unreadable ? kept->kind->file : NULL;
}

enum refusal_code kept_list_refusal(const struct kept_list *kept)
{
    return !kept->path ? REFUSAL_UNRECORDED : kept->unreadable ? REFUSAL_KEPT_UNREAD : REFUSAL_NONE;
}

/* --- changes ---------------------------------------------------------------------------------------------------------------- */

struct list_job {
    /* first member, because file_writer passes a pointer to it, which is cast to a list_job pointer; its `owner` is `kept` */
    struct file_job job;
    struct kept_list *kept;
    json_t *list;
    char *folder, *path, *text;
    bool mirrored; /* true: the list is a copy of another daemon's list; it replaces `kept->list` even if it cannot be written to disk */
};

static void put_in_force(struct kept_list *kept, json_t *list)
{
    json_t *before = kept->list;
    kept->list = json_incref(list);
    kept->number++;
    json_decref(before);
}

static int write_list(struct file_job *job)
{
    const struct list_job *own = (const struct list_job *)job;
    mkdir(own->folder, 0777); /* errors are ignored here: if the folder cannot be created, writing the file reports the reason */
    return own->text ? atomic_file_keep(own->path, own->text, strlen(own->text)) : -ENOMEM;
}

static void finish_list(struct file_job *job, int error)
{
    struct list_job *own = (struct list_job *)job;
    struct kept_list *kept = job->owner ? own->kept : NULL;
    if (kept && error)
        log_err(kept->log, "%s: %s", kept->path, strerror(-error));
    if (kept && (!error || own->mirrored))
        put_in_force(kept, own->list);
    /* after an error, all changes that were queued behind the failed one fail, too */
    if (kept && job->number && (error || kept->next == own->list)) {
        json_decref(kept->next);
        kept->next = NULL;
    }
    json_decref(own->list);
    mem_free(own->folder);
    mem_free(own->path);
    free(own->text);
    mem_free(own);
}

static enum refusal_code put(struct kept_list *kept, json_t *list, bool mirrored)
{
    if (!kept->path) {
        put_in_force(kept, list);
        json_decref(list);
        return REFUSAL_NONE;
    }
    json_t *file = json_pack("{s:i,s:O}", "version", VERSION, kept->kind->key, list);
    struct list_job *own = mem_new(sizeof(*own));
    *own = (struct list_job){ .job = { .write = write_list, .finish = finish_list, .owner = kept },
                              .kept = kept,
                              .list = list,
                              .folder = mem_strdup(kept->folder),
                              .path = mem_strdup(kept->path),
                              .text = json_dumps(file, JSON_INDENT(1)),
                              .mirrored = mirrored };
    json_decref(file);
    json_incref(list);
    int error = file_writer_queue(kept->writer, &own->job);
    if (error || !kept->writer) {
        json_decref(list);
    } else {
        json_decref(kept->next);
        kept->next = list;
    }
    return atomic_file_not_kept(error);
}

enum refusal_code kept_list_put(struct kept_list *kept, json_t *list)
{
    return put(kept, list, false);
}

bool kept_list_mirror(struct kept_list *kept, json_t *list)
{
    if (!good_list(kept->kind, list))
        return false;
    if (json_equal(kept_list_newest(kept), list))
        return true;
    if (kept->path && !kept->unreadable) /* also writes the list to disk on a standby core, because that core may become the leader */
        put(kept, json_incref(list), true);
    else
        put_in_force(kept, list);
    return true;
}
