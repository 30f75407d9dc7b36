/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plant's exports folder, for unmodified exports from other systems: models, files that models refer to, and one tag list.
   Call from any thread, but for each folder from one thread at a time. */
#ifndef IMPORTING_EXPORT_FOLDER_H
#define IMPORTING_EXPORT_FOLDER_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum export_kind {
    EXPORT_MODEL,
    EXPORT_BESIDE, /* a file that a model in the same folder refers to: attributes, buffers, images, materials */
    EXPORT_TAGS
};

struct export_file {
    char *name;
    enum export_kind kind;
    int64_t bytes;
};

struct export_list { /* files of the exports folder, sorted by name */
    struct export_file *at;
    size_t count, capacity;
};

/* Returns the path PLANT_FOLDER/exports; free with mem_free(). */
char *export_folder_of(const char *plant_folder);
/* Returns true if the name is valid for a file of the exports folder: UTF-8 of at most 200 bytes, not hidden, without slashes
   and control characters. */
bool export_name_good(const char *name);
/* Returns the kind of a file of the exports folder (model, tag list and so on), determined from its name. */
enum export_kind export_kind_of(const char *name);
/* Lists the uploaded files of the exports folder. A folder that cannot be read counts as empty. */
void export_folder_list(const char *folder, struct export_list *list);
void export_list_finish(struct export_list *list);
/* Returns the name (static text) of the hidden file that stores the units and axes last used for reading models. */
const char *export_folder_choice(void);
/* Returns the name (static text) of the hidden file that contains the report of `plantcast import`. */
const char *export_folder_report(void);
/* Removes the hidden files left by unfinished uploads. */
void export_folder_sweep(const char *folder);
/* Removes all tag lists from the exports folder except the file named `except`, because an import needs exactly one. except
   NULL: removes all tag lists. */
void export_folder_remove_tag_lists(const char *folder, const char *except);
/* Removes a file from the exports folder. Returns 0 or -errno. The name must be valid (export_name_good()). */
int export_folder_remove(const char *folder, const char *name);

/* --- uploading one file, which is hidden until it is complete; functions that return int return 0 or -errno --- */

struct export_upload;
/* Begins the upload of a file, which replaces any file of the same name when the upload ends. Returns NULL with *error =
   -errno. The name must be valid (export_name_good()). */
struct export_upload *export_upload_begin(const char *folder, const char *name, int *error);
int export_upload_write(struct export_upload *upload, const void *bytes, size_t count);
/* Completes the upload: gives the file its final name. Frees the upload even on error; sets *upload to NULL. */
int export_upload_end(struct export_upload **upload);
/* Removes the incomplete file and frees the upload. Accepts a pointer to NULL; sets *upload to NULL. */
void export_upload_abandon(struct export_upload **upload);

#endif
