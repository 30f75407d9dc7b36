/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tag list on disk: a new one takes the name, the one before stays beside it as NAME.1, NAME.2, ... Nothing is ever overwritten.
   Thread: any, one at a time for one list. */
#ifndef PLACING_TAG_FILE_H
#define PLACING_TAG_FILE_H
#include <stdbool.h>
#include <stdint.h>

struct tag_save { /* a list that somebody has seen the difference of, and wants in force */
    char *path;
    char *before, *after; /* texts: what is in force, what shall be */
    char *who;
    uint64_t client; /* whose answer it is */
    uint32_t seq;
};
void tag_save_free(struct tag_save *save); /* NULL is fine */

/* The text (mem_free). NULL: *why (mem_free). */
char *tag_file_read(const char *path, char **why);
/* Which text it is: 16 hexadecimal digits. */
void tag_file_hash(const char *text, char out[17]);
/* Puts save->after in place. *kept: the name, beside it, of the list as it was (mem_free). False: nothing has changed on disk, *why. */
bool tag_file_put(const struct tag_save *save, char **kept, char **why);
/* Undoes that: the list is as before, and `kept` is gone. False: *why. */
bool tag_file_put_back(const struct tag_save *save, const char *kept, char **why);

#endif
