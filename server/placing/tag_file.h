/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tag list on disk. A new version gets the list's name, and the previous one is kept as NAME.1, NAME.2, ... No version is
   ever overwritten. Call from any thread, but for each list from one thread at a time. */
#ifndef PLACING_TAG_FILE_H
#define PLACING_TAG_FILE_H
#include <stdbool.h>
#include <stdint.h>

#include "base/refusal.h"

/* A request to save a tag list. Its user has seen how the list differs from the present one. */
struct tag_save {
    char *path;
    char *before, *after; /* text of the present tag list, and text of the list to save */
    char *who;
    uint64_t client; /* id of the client that asked to save the list and gets the answer */
    uint32_t seq;
};
/* Frees a request to save a tag list. Accepts NULL. */
void tag_save_free(struct tag_save *save);

/* Returns the text of the tag list; free with mem_free(). Returns NULL on failure, with the reason in *why. */
char *tag_file_read(const char *path, struct refusal *why);
/* Writes a hash of the tag list's text, which identifies its version, as 16 hexadecimal digits. */
void tag_file_hash(const char *text, char out[17]);
/* Keeps the present tag list under the first unused name of NAME.1, NAME.2, ..., by a second hard link. Returns that name
   (mem_free), or NULL with the reason in *why. */
char *tag_file_keep(const char *path, struct refusal *why);
/* Saves save->after under the list's name. *kept receives the path of the previous version (mem_free). On failure, returns
   false with the reason in *why, and nothing has changed on disk. */
bool tag_file_put(const struct tag_save *save, char **kept, struct refusal *why);
/* Undoes tag_file_put(): gives the kept version the list's name again. Returns false with the reason in *why (mem_free). */
bool tag_file_put_back(const struct tag_save *save, const char *kept, char **why);

#endif
