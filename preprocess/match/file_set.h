/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files of a plant's folder that one run replaces: all of them are on disk beside the old ones before the first takes its place, and they
 * take their places in the order in which they were added. Functions that return int return 0 or -errno. Thread: one. */
#ifndef PREPROCESS_MATCH_FILE_SET_H
#define PREPROCESS_MATCH_FILE_SET_H
#include <stdbool.h>

#include "base/files/atomic_file.h"
#include "plant/plant_folder.h"

enum { FILE_SET_ROOM = 3 };

struct file_set { /* zero-initialise */
    struct atomic_file files[FILE_SET_ROOM];
    int count;
};

/* Takes the folder as plant_folder_lock() does, and also removes what killed runs left in it. */
int file_set_lock(const struct plant_folder_params *params, char **why);
/* Writes what will be at `path` beside it, with the owner and rights of the file that is there; where that is a link, beside its target. */
int file_set_add(struct file_set *set, const char *path, const char *text);
/* Puts all of them in their places. On failure those before stay replaced, and the rest is removed. */
int file_set_commit(struct file_set *set);
void file_set_abandon(struct file_set *set); /* removes what is not in its place; none is fine */

#endif
