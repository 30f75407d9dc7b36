/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A list of entries made by users, stored as JSON in a file of the history's folder. Each entry has an `id`. Call only in the event
   loop. */
#ifndef VIEWS_KEPT_LIST_H
#define VIEWS_KEPT_LIST_H
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/files/file_writer.h"
#include "base/refusal.h"

struct kept_list_kind {
    /* file: name of the file in the history's folder; key: name of the JSON member in it that contains the list */
    const char *file, *key;
    const char *members; /* names of the members that each entry must have, as words for a log message, such as "id, text and time_us" */
    size_t most;         /* maximum number of entries */
    /* names of the members that must be texts (among them `id`) and integers; both end with NULL */
    const char *texts[8], *integers[4];
    bool (*good)(const json_t *entry); /* callback: returns whether the values of an entry that has all these members are valid */
};

/* list of users' entries; the owner of this struct may read `list`, but only the functions below change it */
struct kept_list {
    struct log *log;
    const struct kept_list_kind *kind;
    const char *folder;
    char *path; /* path of the file; NULL: the list is not stored on disk */
    struct file_writer *writer;
    json_t *list;    /* entries as the file on disk has them; clients are sent these */
    json_t *next;    /* entries as they will be once all queued changes are written; NULL: no change is queued */
    uint64_t number; /* change counter of `list` */
    bool unreadable;
};

/* Reads the list. folder: the history's folder, which need not exist; NULL: none. An unreadable file counts as empty (logged)
   and is not overwritten. writer: the thread that writes changes; NULL: changes are written immediately. `folder`, `kind` and
   `writer` must outlive the list. */
void kept_list_open(struct kept_list *kept, struct log *log, const char *folder, const struct kept_list_kind *kind,
                    struct file_writer *writer);
void kept_list_close(struct kept_list *kept);
/* Returns the list to which the next change must be made, including changes that are queued for the disk. */
json_t *kept_list_newest(const struct kept_list *kept);
/* Returns the index of the entry with this id, or the length of the list if no entry has it. */
size_t kept_list_find(const json_t *list, const char *id);
/* Returns the name of the list's file (static) if that file could not be read; otherwise NULL. */
const char *kept_list_unread_file(const struct kept_list *kept);
/* Returns REFUSAL_NONE if the list can be changed, else the reason why it cannot. */
enum refusal_code kept_list_refusal(const struct kept_list *kept);
/* Queues the new list for writing to disk; once it is written, file_writer_collect() replaces `list`. Without a folder or a writer the list
   is replaced before this function returns. Takes ownership of `list`. Returns REFUSAL_NONE, or why it failed. */
enum refusal_code kept_list_put(struct kept_list *kept, json_t *list);

/* Replaces the list with that of another daemon. Only a standby core also writes it to disk; the list is replaced even if that
   fails (logged). Returns false, with nothing changed, if the list is invalid. */
bool kept_list_mirror(struct kept_list *kept, json_t *list);

#endif
