/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A list of the paths that a confined child may use. Call from any thread, but for each list from one thread at a time. */
#ifndef PREPROCESS_CHILD_CHILD_PATHS_H
#define PREPROCESS_CHILD_CHILD_PATHS_H
#include "base/system/confine.h"

struct child_paths { /* list of paths and the access allowed to each; zero-initialise */
    struct confine_path *at;
    size_t count, capacity;
};

/* Adds a path, after resolving symlinks. Ignores NULL and paths that do not exist. */
void child_paths_add(struct child_paths *paths, const char *path, enum confine_access access);
/* Adds the folder that contains the file `path`. */
void child_paths_add_folder_of(struct child_paths *paths, const char *path, enum confine_access access);
/* Adds files with one of these endings (".bin .png", lower case) for reading: at most 4096 files, in the folder of `input` and
 * up to three levels below. Other files in these folders, such as keys, stay inaccessible. */
void child_paths_add_beside(struct child_paths *paths, const char *input, const char *endings);
/* Creates links in `folder` to the files with one of these endings (at most 4096) in the folder of `input`: to each file under its
 * name, and under its name in lower case, for a confined child that cannot list the folder of `input`. Keeps existing files. */
void child_paths_link_beside(const char *folder, const char *input, const char *endings);
/* Adds everything a site's shell command needs: installed programs, the folders of $PATH, configuration in /etc except Plantcast's, and the
 * files and folders that the command names by absolute paths. */
void child_paths_add_command(struct child_paths *paths, const char *command);
/* Adds the folders that hold this program's modules (base/system/module.h): the program's own folder, and ../lib/plantcast. */
void child_paths_add_modules(struct child_paths *paths);
void child_paths_finish(struct child_paths *paths);

#endif
