/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A list of entries made by users, stored as JSON in a file of the history's folder. Each entry has an `id`. Thread: the loop. */
#ifndef VIEWS_KEPT_LIST_H
#define VIEWS_KEPT_LIST_H
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/log/log.h"
#include "base/refusal.h"

struct kept_list_kind {
    const char *file, *key;           /* file name, and the name of the member that holds the list */
    const char *members;              /* names of members of an entry, which the log names */
    bool (*good)(const json_t *list); /* returns whether a list from a file is valid */
};

/* Only the functions below change it; its owner may read `list`. */
struct kept_list {
    struct log *log;
    const struct kept_list_kind *kind;
    const char *folder;
    char *path; /* path of the file; NULL: nothing is stored on disk */
    json_t *list;
    uint64_t number; /* change counter */
    bool unreadable;
};

/* Reads the list. folder: the history's folder, which need not exist; NULL: none. An unreadable file counts as empty (logged) and is not
   overwritten. `folder` and `kind` must outlive the list. */
void kept_list_open(struct kept_list *kept, struct log *log, const char *folder, const struct kept_list_kind *kind);
void kept_list_close(struct kept_list *kept);
/* Returns the index of the entry with that id; the length of the list if none has it. */
size_t kept_list_find(const json_t *list, const char *id);
/* Returns REFUSAL_NONE if the list can be changed, else the reason why not. */
enum refusal_code kept_list_refusal(const struct kept_list *kept);
/* Writes the new list to disk, and then replaces the list in memory; without a folder only the latter. Takes ownership of `list`. Returns
   REFUSAL_NONE, or why it failed. */
enum refusal_code kept_list_put(struct kept_list *kept, json_t *list);

/* Replaces the list by that of another daemon; only a standby core writes it to disk. Returns false, with nothing changed, if the list
   is invalid. */
bool kept_list_mirror(struct kept_list *kept, json_t *list);

#endif
