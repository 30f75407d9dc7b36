/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The folder of a plant with unchanged exports of other systems: models, files that models refer to, and one tag list. Thread: any, one
   at a time per folder. */
#ifndef IMPORTING_EXPORT_FOLDER_H
#define IMPORTING_EXPORT_FOLDER_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum export_kind {
    EXPORT_MODEL,
    EXPORT_BESIDE, /* file that a model of the same folder refers to: attributes, buffers, images, materials */
    EXPORT_TAGS
};

struct export_file {
    char *name;
    enum export_kind kind;
    int64_t bytes;
};

struct export_list { /* sorted by name */
    struct export_file *at;
    size_t count, capacity;
};

/* Returns PLANT_FOLDER/exports; mem_free. */
char *export_folder_of(const char *plant_folder);
/* Returns whether a file name is acceptable: UTF-8 of at most 200 bytes, not hidden, without slashes and control characters. */
bool export_name_good(const char *name);
/* Returns the kind of a file by its name. */
enum export_kind export_kind_of(const char *name);
/* Lists the files that were uploaded. An unreadable folder counts as empty. */
void export_folder_list(const char *folder, struct export_list *list);
void export_list_finish(struct export_list *list);
/* Returns the name of the hidden file that stores the units and axes with which models were read. Static. */
const char *export_folder_choice(void);
/* Returns the name of the hidden file with the report of plantcast import. Static. */
const char *export_folder_report(void);
/* Removes the remains of unfinished uploads. */
void export_folder_sweep(const char *folder);
/* Removes all tag lists except the one of that name (NULL: all): the folder has only one at a time. */
void export_folder_remove_tag_lists(const char *folder, const char *except);
/* Removes a file. Returns 0 or -errno. The name must be acceptable (export_name_good()). */
int export_folder_remove(const char *folder, const char *name);

/* --- upload of one file, hidden until it is complete. Functions that return int return 0 or -errno. */

struct export_upload;
/* Begins an upload, which replaces a file of the same name when it ends. Returns NULL with *error = -errno. The name must be acceptable. */
struct export_upload *export_upload_begin(const char *folder, const char *name, int *error);
int export_upload_write(struct export_upload *upload, const void *bytes, size_t count);
/* Completes the upload and makes the file visible. Frees the upload even after an error; leaves NULL. */
int export_upload_end(struct export_upload **upload);
/* Removes the partial file and frees the upload. &NULL is fine; leaves NULL. */
void export_upload_abandon(struct export_upload **upload);

#endif
