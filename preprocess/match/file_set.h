/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Replaces several files of a plant's folder. All new files are written to disk before the first old one is replaced; they are
 * replaced in the order they were added. Functions that return int return 0 or -errno. Call from one thread only. */
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

/* Locks the folder as plant_folder_lock() does, and removes temporary files left by killed runs. Returns the lock's descriptor,
 * or -errno. */
int file_set_lock(const struct plant_folder_params *params, char **why);
/* Writes the new content of `path` to a temporary file in the same folder, with the owner and mode of the existing file. If `path` is a
 * symlink, its target will be replaced. */
int file_set_add(struct file_set *set, const char *path, const char *text);
/* Renames all temporary files of the set to their final names. On failure, files already renamed stay replaced, and the other
 * temporary files are removed. */
int file_set_commit(struct file_set *set);
/* Removes temporary files that were not committed, and empties the set. The set may be empty. */
void file_set_abandon(struct file_set *set);

#endif
