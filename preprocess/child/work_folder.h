/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A temporary folder for output files. On success, the files are moved to their target; on failure, nothing remains. Call from any
   thread. */
#ifndef PREPROCESS_CHILD_WORK_FOLDER_H
#define PREPROCESS_CHILD_WORK_FOLDER_H
#include <signal.h>
#include <stdbool.h>

struct work_folder {
    char *path;      /* absolute path of the temporary folder */
    char *target;    /* folder that will receive the finished files; NULL: the files are not kept */
    bool created;    /* true: work_folder_begin() created the folder `target` */
    sigset_t before; /* signal mask before work_folder_begin() */
};

/* Creates a new folder inside `target`, which is created if missing; target NULL: inside the system's temporary folder. Blocks SIGINT and
 * SIGTERM until work_folder_end(), so that an interruption leaves no files behind. Returns 0, or -errno; then work_folder_end() need not be
 * called. */
int work_folder_begin(struct work_folder *work, const char *target);
/* Returns whether SIGINT or SIGTERM is pending, so that the caller should stop. */
bool work_folder_interrupted(void);
/* Removes the folder and its contents. If keep is false, also removes the target if work_folder_begin() created it and it is empty. */
void work_folder_end(struct work_folder *work, bool keep);

#endif
