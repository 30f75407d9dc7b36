/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A list of what people made, kept as JSON in a file of the history's folder. Each of its entries has an `id`. Thread: the loop. */
#ifndef VIEWS_KEPT_LIST_H
#define VIEWS_KEPT_LIST_H
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/log/log.h"
#include "base/refusal.h"

struct kept_list_kind {
    const char *file, *key;           /* the file's name, and the member that is the list */
    const char *members;              /* of each entry, for the log */
    bool (*good)(const json_t *list); /* whether a list from a file can be used */
};

/* Only functions below change it; `list` is read by its owner. */
struct kept_list {
    struct log *log;
    const struct kept_list_kind *kind;
    const char *folder;
    char *path; /* NULL: nothing is kept on disk */
    json_t *list;
    uint64_t number; /* increases with each change */
    bool unreadable;
};

/* Reads the list. folder: of the history, which need not exist; NULL: there is none. A file that cannot be read counts as empty (logged)
   and is not written over. folder and kind must outlive it. */
void kept_list_open(struct kept_list *kept, struct log *log, const char *folder, const struct kept_list_kind *kind);
void kept_list_close(struct kept_list *kept);
/* Returns the index of the entry with that id; the length of the list: there is none. */
size_t kept_list_find(const json_t *list, const char *id);
/* Returns why nothing can be changed (static), or NULL. */
enum refusal_code kept_list_refusal(const struct kept_list *kept);
/* Takes a list in place of the one there is, once it is on disk (without a folder, at once). Returns NULL, or why it could not (static). */
enum refusal_code kept_list_put(struct kept_list *kept, json_t *list);

/* Takes a list as another daemon keeps it, and writes nothing. Returns false if it is none of that kind; then nothing changed. */
bool kept_list_mirror(struct kept_list *kept, json_t *list);

#endif
