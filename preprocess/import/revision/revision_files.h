/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files of a plant's folder that are replaced together, and can be put back together (plant_folder.h, which has to have the folder). A
 * program that is killed at any time leaves either the old files or work that the next one finishes. Functions that return int return 0 or
 * -errno. Thread: one. */
#ifndef PREPROCESS_IMPORT_REVISION_FILES_H
#define PREPROCESS_IMPORT_REVISION_FILES_H
#include <stdbool.h>
#include <stddef.h>

#include "base/text/text.h"

struct revision_file {
    const char *name;   /* in the folder; or an absolute path: it lies elsewhere */
    char *made;         /* path of the new one, inside the folder; NULL: it stays as it is, and is remembered, for what others do to it */
    const char *before; /* its text as it was when it was read, or NULL */
};

/* Replaces the files, in this order, and remembers those of before in place of what was remembered. work is a folder inside `folder`.
 * -ESTALE: a file is not as it was read (`before`); *changed is its name, and nothing was done. */
int revision_files_apply(const char *folder, const char *work, const struct revision_file *files, size_t count, const char **changed);

/* Puts back the files of before the last revision. What has changed since is named in `changed`, separated by ", ", and then nothing is
 * done, unless forced: then those files stay beside, as NAME.undone. Names of files that were put back are appended to `done`.
 * -ENOENT: there is no revision; -EBUSY: files have changed since. */
int revision_files_undo(const char *folder, bool forced, struct text *changed, struct text *done);

#endif
