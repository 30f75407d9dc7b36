/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The folder of prepared files: KEY.asset and manifest.json (protocol/ASSET.md), KEY.report.json, and the build cache's files.
   Call from one thread only, unless a function says otherwise. */
#ifndef PREPROCESS_CACHE_FOLDER_H
#define PREPROCESS_CACHE_FOLDER_H
#include <jansson.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/files/atomic_file.h"
#include "base/log/log.h"
#include "protocol/asset_format.h"

/* a KEY.asset file that is mapped for reading */
struct folder_file {
    void *bytes;
    size_t size;
    struct asset_view view;
    uint16_t *codes; /* distances of the asset's vertices, unpacked from the file; NULL: none, or the file stores them unpacked */
};

/* Returns the file name KEY.asset. The caller frees it (mem_free). */
char *folder_file_name(uint64_t key);

/* Return the paths FOLDER/KEY.asset and FOLDER/KEY.influence. The caller frees them (mem_free). */
char *folder_asset_path(const char *folder, uint64_t key);
char *folder_influence_path(const char *folder, uint64_t key);

/* Locks the folder's lock file, so that only one process at a time prepares into the folder. Returns the file descriptor, which
 * holds the lock until it is closed. While another process holds the lock, logs its process id and waits until the lock is free
 * or *stop is true (stop NULL: never stops). Returns -1 if it was stopped or the lock file cannot be created. */
int folder_lock(const char *folder, struct log *log, const atomic_bool *stop);

/* Maps FOLDER/KEY.asset and checks it. Returns 1 with *file set (until folder_close()), 0 if there is no such file, or -1 if it is damaged,
   with the reason in why. */
int folder_open(struct folder_file *file, const char *folder, uint64_t key, char why[200]);
/* Unpacks the distances if the file stores them packed, as it does when there are many sensors. Returns false if out of memory. */
bool folder_unpack(struct folder_file *file);
/* Unmaps the file. */
void folder_close(struct folder_file *file);

/* A KEY.asset file being written through a mapping. The file has no name before folder_put(). */
struct folder_draft {
    void *bytes; /* mapped bytes, initially zeros; NULL: nothing is mapped */
    size_t size;
    struct atomic_file file;
};
/* Creates an unnamed file of `size` bytes, which will become KEY.asset, reserves its disk space, and maps it for writing. Returns 0 or
 * -errno. */
int folder_draft(struct folder_draft *draft, const char *folder, uint64_t key, size_t size);
/* Starts writing the draft of an asset file to disk without waiting; folder_put() waits until everything is written. */
void folder_draft_send(const struct folder_draft *draft);
/* Writes KEY.report.json (unless report is NULL), then gives the draft its name KEY.asset, so that every asset file has its report. The
 * draft stays mapped until it is closed. Returns 0 or -errno. */
int folder_put(struct folder_draft *draft, const char *folder, uint64_t key, const char *report);
/* Unmaps and closes the draft. The kernel deletes the file unless folder_put() has named it. A zeroed draft is allowed. */
void folder_draft_close(struct folder_draft *draft);
/* Returns the contents of KEY.report.json, which the caller frees (json_decref). Logs and returns NULL if the file is missing or
   damaged. */
json_t *folder_report(struct log *log, const char *folder, uint64_t key);

/* An asset's entry in the manifest. */
struct folder_entry {
    const char *id;
    /* recipe: hash of all inputs of the asset except its sensors (plant/recipe.h); model: hash of the model file, of all files that it
     * refers to, and of panoramas and fitted readings */
    uint64_t key, recipe, model;
    uint64_t cuts; /* hash of the parameters for which triangles were cut (plant_cuts_recipe()) */
    uint64_t geometry_key, distances_key;
    const char *missing;     /* reason why the asset has no prepared file; NULL: it has one */
    const double *placement; /* matrix of 16 numbers, column-major: transform from the asset frame to the plant frame */
    const char *const *tags; /* tags of the asset's sensors, in the order of the asset file */
    size_t tag_count;
    /* list of the model's textures and extensions that are not drawn, for plantcastd --check; NULL: copy the model's list from the
     * old manifest. Give each model's list to one asset only. */
    const char *const *left_out;
    size_t left_out_count;
};
/* Writes manifest.json for these assets if it has changed. Then deletes prepared files whose key belongs to no asset; *removed
 * receives their number (removed NULL: deletes nothing). Logs a damaged old manifest. Returns 0 or -errno. */
int folder_finish(struct log *log, const char *folder, const struct folder_entry *entries, size_t count, size_t *removed);

#endif
