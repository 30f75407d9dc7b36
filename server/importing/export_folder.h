/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The folder of a plant that holds exports of other systems as they came: models, files beside them, and one tag list. Thread: any, one at
   a time per folder. */
#ifndef IMPORTING_EXPORT_FOLDER_H
#define IMPORTING_EXPORT_FOLDER_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum export_kind {
    EXPORT_MODEL,
    EXPORT_BESIDE, /* what a model of the same folder refers to: attributes, buffers, images, materials */
    EXPORT_TAGS
};

struct export_file {
    char *name;
    enum export_kind kind;
    int64_t bytes;
};

struct export_list { /* by name, ascending */
    struct export_file *at;
    size_t count, capacity;
};

/* Returns PLANT_FOLDER/exports; mem_free. */
char *export_folder_of(const char *plant_folder);
/* Returns whether a file of that name is taken: UTF-8 of at most 200 bytes, not hidden, without slashes and control characters. */
bool export_name_good(const char *name);
/* Returns what a name says its file is. */
enum export_kind export_kind_of(const char *name);
/* Lists the files that were taken. An unreadable folder has none. */
void export_folder_list(const char *folder, struct export_list *list);
void export_list_finish(struct export_list *list);
/* Returns the name, in the folder, of a hidden file that stays: how models were read. Static. */
const char *export_folder_choice(void);
/* Returns the name of the hidden file with the report of plantcast import. Static. */
const char *export_folder_report(void);
/* Removes what uploads left that never ended. */
void export_folder_sweep(const char *folder);
/* Removes tag lists but for the one of that name (NULL: all): there is one at a time. */
void export_folder_remove_tag_lists(const char *folder, const char *except);
/* Returns 0 or -errno. The name must be good. */
int export_folder_remove(const char *folder, const char *name);

/* --- a file on its way: unseen until it is whole. Functions that return int return 0 or -errno. */

struct export_upload;
/* Begins a file, which takes the place of one of the same name at its end. NULL with *error = -errno. The name must be good. */
struct export_upload *export_upload_begin(const char *folder, const char *name, int *error);
int export_upload_write(struct export_upload *upload, const void *bytes, size_t count);
/* Puts the file in its place; frees the upload either way, leaves NULL. */
int export_upload_end(struct export_upload **upload);
/* Removes what was written. &NULL is fine; leaves NULL. */
void export_upload_abandon(struct export_upload **upload);

#endif
