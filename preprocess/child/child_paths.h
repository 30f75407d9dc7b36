/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A growing list of the paths that a confined child may use. Thread: any, one at a time per list. */
#ifndef PREPROCESS_CHILD_CHILD_PATHS_H
#define PREPROCESS_CHILD_CHILD_PATHS_H
#include "base/system/confine.h"

struct child_paths { /* zero-initialise */
    struct confine_path *at;
    size_t count, capacity;
};

/* Adds a copy of the path, with symlinks resolved. NULL and paths that do not exist are skipped. */
void child_paths_add(struct child_paths *paths, const char *path, enum confine_access access);
/* Adds the folder that a file is in. */
void child_paths_add_folder_of(struct child_paths *paths, const char *path, enum confine_access access);
/* Adds, for reading, files that have one of these endings (".bin .png", lower case) and lie in the folder of `input` or up to three folders
 * below, 4096 at most. Other files of that folder, such as keys, stay out of reach. */
void child_paths_add_beside(struct child_paths *paths, const char *input, const char *endings);
/* Adds what a shell command of the site needs: installed programs, the folders of PATH, settings in /etc other than Plantcast's, and the
 * files and folders that the command names by absolute paths. */
void child_paths_add_command(struct child_paths *paths, const char *command);
/* Adds the folders where modules of this program lie (base/system/module.h): its own, and ../lib/plantcast. */
void child_paths_add_modules(struct child_paths *paths);
void child_paths_finish(struct child_paths *paths);

#endif
