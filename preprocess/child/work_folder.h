/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A folder for what is made, until all of it is good: then its files are moved to where they belong, else nothing stays. Thread: any. */
#ifndef PREPROCESS_CHILD_WORK_FOLDER_H
#define PREPROCESS_CHILD_WORK_FOLDER_H
#include <signal.h>
#include <stdbool.h>

struct work_folder {
    char *path;      /* absolute */
    char *target;    /* where its files will go; NULL: nowhere */
    bool created;    /* the target was not there before */
    sigset_t before; /* which signals were blocked */
};

/* Makes a new folder inside `target`, which is made too if it is not there, or with target NULL among the system's temporary files. SIGINT
 * and SIGTERM wait until its end, so that they leave nothing behind. Returns 0, or -errno, and then there is nothing to end. */
int work_folder_begin(struct work_folder *work, const char *target);
/* Returns whether a signal waits: then nothing more needs to be done. */
bool work_folder_interrupted(void);
/* Removes the folder and all in it, and with `keep` false the target too if it was made for it and is empty. */
void work_folder_end(struct work_folder *work, bool keep);
/* Removes a folder and everything in it, without following symlinks. Returns 0 or -errno. */
int work_folder_remove(const char *path);

#endif
