/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Exclusive access to a plant's folder. Only one program at a time may change files in it: an import, a match, or a daemon that
   saves. A revision (an import or its undoing) replaces several files together. If a program is killed during a revision, the
   next program that locks the folder finishes the revision. A revision has a record: a folder inside the plant's folder, whose
   name tells its state. .revision: the revision is complete; .revision.pending: the files new/NAME are being moved into place;
   .revision.undoing: the files old/NAME are being moved back. The record's file `files` has lines "HASH WAS NAME"; WAS is 1 if
   old/NAME is the previous version. A file in another folder is listed by its path; its versions are called elsewhere-NAME.
   Functions that return int return 0 or -errno. Call from any thread, but for each folder from one thread at a time. */
#ifndef PLANT_PLANT_FOLDER_H
#define PLANT_PLANT_FOLDER_H
#include <stdbool.h>
#include <stddef.h>

#define REVISION_MADE ".revision"
#define REVISION_PENDING ".revision.pending"
#define REVISION_UNDOING ".revision.undoing"

struct plant_folder_params {
    const char *folder;
    /* path of the work folder that this program has made in the plant's folder, so that it is not removed as left by a killed
       program; NULL: none */
    const char *own;
    int lent;    /* open descriptor of the folder, inherited from the parent process, which holds the lock; 0: none */
    int wait_ms; /* milliseconds to wait for another program to finish; 0: no waiting */
    /* receives what this program finished on behalf of a killed one: "an import", "the undoing of an import"; NULL: not wanted */
    const char **finished;
};

/* Locks the folder until the descriptor is closed, removes the work folders that killed programs left in it, and finishes their revisions.
   Returns the descriptor, or -errno with a one-line reason in *why (mem_free), which does not name the folder. */
int plant_folder_lock(const struct plant_folder_params *params, char **why);
/* Call this before reading a plant's files. Waits for a revision (import or its undoing) in progress, and finishes the revision
   of a killed program. Also removes what killed programs left, unless another program has locked the folder. Returns true once
   no revision is in progress; false: *why has a one-line reason (mem_free). Sets *params->finished. */
bool plant_folder_settle(const struct plant_folder_params *params, char **why);
/* Returns true if a revision (import or its undoing) is in progress or was interrupted by a kill. The files in the folder are
   then neither the old plant nor the new one. */
bool plant_folder_unsettled(const char *folder);
/* Removes a folder and everything in it, without following symlinks. Returns 0 or -errno. */
int plant_folder_remove(const char *path);
/* Returns the folder of a plant file; free with mem_free(). */
char *plant_folder_of(const char *plant_path);

/* --- for programs that make revisions: --- */

struct revision_entry {
    char *name;
    unsigned long long hash; /* hash of the new file */
    bool was;                /* a previous version existed */
};
struct revision_record {
    char *path;
    struct revision_entry *entries;
    size_t count, room;
};
/* Reads the record of the revision from the folder `name` (.revision, .revision.pending or .revision.undoing). Call
   revision_record_finish() even after an error. */
int revision_record_read(struct revision_record *record, const char *folder, const char *name);
void revision_record_finish(struct revision_record *record);
/* Finish applying, or undoing, a revision that a killed program began. This program must have locked the folder. */
int revision_go_on_applying(const char *folder);
int revision_go_on_undoing(const char *folder);
/* Returns the path of one version ("old" or "new") of a file in a revision's record; free with mem_free(). `name` may be an absolute
   path. */
char *revision_version_of(const char *record, const char *version, const char *name);
/* Returns the path of a file in the plant's folder; free with mem_free(). `name` may be an absolute path. */
char *plant_folder_file(const char *folder, const char *name);
int plant_folder_sync(const char *folder);

#endif
