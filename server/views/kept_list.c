/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stores each list in one file. Every change writes the whole file, because the lists are short. */
#include "views/kept_list.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"

size_t kept_list_find(const json_t *list, const char *id)
{
    size_t i = 0;
    while (i < json_array_size(list) && strcmp(json_string_value(json_object_get(json_array_get(list, i), "id")), id) != 0)
        i++;
    return i;
}

static void read_file(struct kept_list *kept)
{
    json_error_t error = { 0 };
    json_t *file = json_load_file(kept->path, JSON_REJECT_DUPLICATES, &error);
    json_t *list = json_object_get(file, kept->kind->key);
    kept->unreadable = !kept->kind->good(list);
    if (kept->unreadable)
        log_err(kept->log, "%s:%d: %s%s%s%s; the file is ignored and not changed", kept->path, file ? 1 : error.line,
                file ? "not a list of " : error.text, file ? kept->kind->key : "", file ? " with " : "", file ? kept->kind->members : "");
    else
        json_array_extend(kept->list, list);
    json_decref(file);
}

void kept_list_open(struct kept_list *kept, struct log *log, const char *folder, const struct kept_list_kind *kind)
{
    *kept = (struct kept_list){ .log = log, .kind = kind, .folder = folder, .list = json_array() };
    kept->path = folder ? mem_printf("%s/%s", folder, kind->file) : NULL;
    if (kept->path && access(kept->path, F_OK) == 0)
        read_file(kept);
    kept->number = json_array_size(kept->list) > 0;
}

void kept_list_close(struct kept_list *kept)
{
    json_decref(kept->list);
    mem_free(kept->path);
}

enum refusal_code kept_list_refusal(const struct kept_list *kept)
{
    return !kept->path ? REFUSAL_UNRECORDED : kept->unreadable ? REFUSAL_KEPT_UNREAD : REFUSAL_NONE;
}

enum refusal_code kept_list_put(struct kept_list *kept, json_t *list)
{
    json_t *file = json_pack("{s:i,s:O}", "version", 1, kept->kind->key, list);
    char *text = json_dumps(file, JSON_INDENT(1));
    if (kept->folder)
        mkdir(kept->folder, 0777); /* errors are ignored, because writing the file reports them */
    int error = !text ? -ENOMEM : kept->path ? atomic_file_keep(kept->path, text, strlen(text)) : 0;
    free(text);
    json_decref(file);
    if (error) {
        log_err(kept->log, "%s: %s", kept->path, strerror(-error));
        json_decref(list);
        return atomic_file_not_kept(error);
    }
    json_decref(kept->list);
    kept->list = list;
    kept->number++;
    return REFUSAL_NONE;
}

bool kept_list_mirror(struct kept_list *kept, json_t *list)
{
    if (!kept->kind->good(list))
        return false;
    if (json_equal(kept->list, list))
        return true;
    if (kept->path && !kept->unreadable) /* a standby core also writes the list to disk, because it may become the leader */
        return kept_list_put(kept, json_incref(list)) == REFUSAL_NONE;
    json_decref(kept->list);
    kept->list = json_incref(list);
    kept->number++;
    return true;
}
