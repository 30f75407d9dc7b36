/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tag list on disk: a new version takes the name, and the previous one is kept beside it as NAME.1, NAME.2, ... Nothing is ever
   overwritten. Thread: any, one at a time per list. */
#ifndef PLACING_TAG_FILE_H
#define PLACING_TAG_FILE_H
#include <stdbool.h>
#include <stdint.h>

#include "base/refusal.h"

/* A request to save a tag list, made by somebody who has seen its difference from the one in force. */
struct tag_save {
    char *path;
    char *before, *after; /* texts: what is in force, what shall be */
    char *who;
    uint64_t client; /* whose answer it is */
    uint32_t seq;
};
/* Frees the request. NULL is fine. */
void tag_save_free(struct tag_save *save);

/* Returns the list's text (mem_free), or NULL with the reason in *why. */
char *tag_file_read(const char *path, struct refusal *why);
/* Writes a hash of the text as 16 hexadecimal digits, by which two versions are told apart. */
void tag_file_hash(const char *text, char out[17]);
/* Keeps the file as it is now under a name that was free, NAME.1, NAME.2, ...: a second link to it. Returns that name, or NULL with the
   reason in *why; mem_free. */
char *tag_file_keep(const char *path, struct refusal *why);
/* Saves save->after under the list's name. *kept receives the name under which the previous version is kept. Returns false with nothing
   changed on disk and the reason in *why. The caller frees *kept (mem_free). */
bool tag_file_put(const struct tag_save *save, char **kept, struct refusal *why);
/* Undoes tag_file_put(): the previous version takes its name back, and `kept` is gone. Returns false with the reason in *why (mem_free). */
bool tag_file_put_back(const struct tag_save *save, const char *kept, char **why);

#endif
