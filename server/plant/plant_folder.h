/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plant's folder, which is one program's at a time while it changes files: an import, a match, a daemon that saves. A revision (an
 * import's or its undoing) is files replaced together; what a program that was killed left of one, whoever takes the folder next finishes.
 * It is a folder inside the plant's, renamed when all that is needed is in it:
 *   .revision          made: nothing of what it lists is under way. files: "HASH WAS NAME" a line; WAS: 1, old/NAME is the one of before.
 *                      A file elsewhere is listed by its path; what is kept of it is elsewhere-NAME
 *   .revision.pending  new/NAME are being put in their places
 *   .revision.undoing  old/NAME are being put back
 * Functions that return int return 0 or -errno. Thread: any; one at a time per folder. */
#ifndef PLANT_PLANT_FOLDER_H
#define PLANT_PLANT_FOLDER_H
#include <stdbool.h>
#include <stddef.h>

#define REVISION_MADE    ".revision"
#define REVISION_PENDING ".revision.pending"
#define REVISION_UNDOING ".revision.undoing"

struct plant_folder_params {
    const char *folder;
    const char *own; /* path of a work folder inside it that stays; NULL: none */
    int lent;        /* descriptor by which the program that started this one has the folder; 0: none */
    int wait_ms;     /* for another program to be done; 0: none */
    const char **finished; /* takes what was killed, and is finished now: "an import", "the undoing of an import"; NULL: not asked */
};

/* Takes the folder until the descriptor is closed, removes what killed programs left in it, and finishes what they had begun. Returns the
 * descriptor, or -errno with one line that does not name the folder in *why (mem_free). */
int plant_folder_lock(const struct plant_folder_params *params, char **why);
/* Before files are read: waits for a revision that is under way, and finishes one that was killed; likewise what else was left is removed,
 * unless the folder is somebody's. Returns whether no revision is under way any more; else *why as above. Has params->finished. */
bool plant_folder_settle(const struct plant_folder_params *params, char **why);
/* Whether a revision is under way, or was killed: what lies in the folder is neither the old plant nor the new one. */
bool plant_folder_unsettled(const char *folder);
/* The folder that a plant file is in; mem_free. */
char *plant_folder_of(const char *plant_path);

/* --- for whoever makes revisions: --- */

struct revision_entry {
    char *name;
    unsigned long long hash; /* of the new file */
    bool was;                /* there was one before */
};
struct revision_record {
    char *path;
    struct revision_entry *entries;
    size_t count, room;
};
/* Reads one of the three. Finish it in both cases. */
int revision_record_read(struct revision_record *record, const char *folder, const char *name);
void revision_record_finish(struct revision_record *record);
/* Go on with one that is pending, or being undone; the folder has to be this program's. */
int revision_go_on_applying(const char *folder);
int revision_go_on_undoing(const char *folder);
/* Where a record has one version ("old", "new") of a file; mem_free. name may be an absolute path. */
char *revision_version_of(const char *record, const char *version, const char *name);
/* Path of a file of the folder; mem_free. name may be an absolute path. */
char *plant_folder_file(const char *folder, const char *name);
int plant_folder_sync(const char *folder);

#endif
