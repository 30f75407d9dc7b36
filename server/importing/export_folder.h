/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The folder of a plant that holds unchanged exports of other systems: models, files that models refer to, and one tag list. Thread:
   any, one at a time per folder. */
#ifndef IMPORTING_EXPORT_FOLDER_H
#define IMPORTING_EXPORT_FOLDER_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum export_kind {
    EXPORT_MODEL,
    EXPORT_BESIDE, /* file to which a model in the same folder refers: attributes, buffers, images, materials */
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
/* Returns true if a file name is acceptable: UTF-8 of at most 200 bytes, not hidden, without slashes and control characters. */
bool export_name_good(const char *name);
/* Returns the kind of a file (model, tag list and so on), judged by its name. */
enum export_kind export_kind_of(const char *name);
/* Lists the uploaded files. An unreadable folder counts as empty. */
void export_folder_list(const char *folder, struct export_list *list);
void export_list_finish(struct export_list *list);
/* Returns the static name of the hidden file that stores the units and axes with which models were read. */
const char *export_folder_choice(void);
/* Returns the static name of the hidden file with the report of `plantcast import`. */
const char *export_folder_report(void);
/* Removes the hidden files that unfinished uploads left. */
void export_folder_sweep(const char *folder);
/* Removes all tag lists except the one named `except` (NULL: removes all), because the folder must not have two. */
void export_folder_remove_tag_lists(const char *folder, const char *except);
/* Removes a file. Returns 0 or -errno. The name must be acceptable (export_name_good()). */
int export_folder_remove(const char *folder, const char *name);

/* --- upload of one file, which is hidden until it is complete. Functions that return int return 0 or -errno. */

struct export_upload;
/* Begins an upload. When it ends, it replaces a file of the same name. Returns NULL with *error = -errno. The name must be acceptable
   (export_name_good()). */
struct export_upload *export_upload_begin(const char *folder, const char *name, int *error);
int export_upload_write(struct export_upload *upload, const void *bytes, size_t count);
/* Completes the upload and makes the file visible. Frees the upload even after an error; sets *upload to NULL. */
int export_upload_end(struct export_upload **upload);
/* Removes the partial file and frees the upload. &NULL is fine; sets *upload to NULL. */
void export_upload_abandon(struct export_upload **upload);

#endif
