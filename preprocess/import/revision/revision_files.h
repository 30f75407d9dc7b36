/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Replaces several files of a plant folder as one transaction that can be undone. The caller must hold the folder's lock
 * (plant_folder.h). If the program is killed at any time, either the old files remain or the next program completes the
 * transaction. Functions that return int return 0 or -errno. Call from one thread only. */
#ifndef PREPROCESS_IMPORT_REVISION_FILES_H
#define PREPROCESS_IMPORT_REVISION_FILES_H
#include <stdbool.h>
#include <stddef.h>

#include "base/text/text.h"

struct revision_file {
    const char *name; /* name of the file in the folder, or its absolute path if it lies elsewhere */
    /* path of the new file, inside the folder; NULL: the file does not change, but is still saved, so that undo detects later
     * changes by others */
    char *made;
    const char *before; /* text of the file when it was read; NULL: not checked */
};

/* Saves the current versions of the files for undo, replacing those saved before, then replaces the files in array order.
 * `work` is a folder inside `folder`. -ESTALE: a file differs from its `before` text; *changed receives its name, and nothing
 * was replaced. */
int revision_files_apply(const char *folder, const char *work, const struct revision_file *files, size_t count, const char **changed);
/* Calls revision_files_apply(). Returns 0, or 1 after printing the reason. */
int revision_files_replace(const char *folder, const char *work, const struct revision_file *files, size_t count);

/* Restores the files saved by the last revision. Appends the names of files that have changed since to `changed`, separated by
 * ", ". If there are any, does nothing unless forced; with forced, keeps those files as NAME.undone. Appends the names of
 * restored files to `done`. -ENOENT: there is no revision to undo; -EBUSY: files have changed since. */
int revision_files_undo(const char *folder, bool forced, struct text *changed, struct text *done);

#endif
