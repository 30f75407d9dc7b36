/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The folder of prepared files: KEY.asset files and manifest.json (protocol/ASSET.md), and what is kept for the next time. */
#ifndef PREPROCESS_CACHE_FOLDER_H
#define PREPROCESS_CACHE_FOLDER_H
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/atomic_file.h"
#include "base/log.h"
#include "protocol/asset_format.h"

/* A file mapped for reading. */
struct folder_file {
    void *bytes;
    size_t size;
    struct asset_view view;
};

/* KEY.asset. Free with mem_free. */
char *folder_file_name(uint64_t key);

/* Holds the folder for this process alone until what it returns is closed, or the process ends. While another one has it, says so with its
   number and waits until *stop is true (NULL: for ever). -1: it was stopped, or no file can be made there, and so nothing written. */
int folder_lock(const char *folder, struct log *log, const atomic_bool *stop);

#define FOLDER_GEOMETRY ".stock"        /* stock.h */
#define FOLDER_SURFACE ".surface"       /* surface_store.h; its key is the stock's */
#define FOLDER_SAMPLES ".spots"         /* spots.h; likewise */
#define FOLDER_DISTANCES ".columns"     /* columns.h */
#define FOLDER_SUBDIVISION ".splitting" /* split_kept.h; its key is the columns' */
/* FOLDER/KEY.ending. Free with mem_free. */
char *folder_path(const char *folder, uint64_t key, const char *ending);

/* 1: there is a whole file with this key (file holds it until folder_close). 0: there is none. -1: there is one, and why says why it is no
   good. */
int folder_open(struct folder_file *file, const char *folder, uint64_t key, char why[200]);
void folder_close(struct folder_file *file);

/* KEY.asset in the making: its bytes are in the file as they are written, so there is one copy of them; for others there is no file until
   it is put in its place. */
struct folder_draft {
    void *bytes; /* mapped; zeros at first. NULL: none */
    size_t size;
    struct atomic_file file;
};
/* 0, or -errno; the disk has room for all of it. */
int folder_draft(struct folder_draft *draft, const char *folder, uint64_t key, size_t size);
/* The disk begins to write what is there so far; folder_put waits for the rest. Not waited for. */
void folder_draft_send(const struct folder_draft *draft);
/* Writes KEY.report.json, then puts KEY.asset in its place; so where there is a file, there is its report. report may be NULL. The bytes
   are there until the draft is closed. 0 or -errno. */
int folder_put(struct folder_draft *draft, const char *folder, uint64_t key, const char *report);
/* One that was not put in its place is removed. A zeroed one is fine. */
void folder_draft_close(struct folder_draft *draft);
/* The text of KEY.report.json, NULL: there is none. Free with mem_free. */
char *folder_report(const char *folder, uint64_t key);

struct folder_entry {
    const char *id;
    uint64_t key, recipe; /* recipe: plant/recipe.h */
    uint64_t geometry_key, distances_key;
    const char *missing;     /* why there is no file; NULL: there is */
    const double *placement; /* 16: plant from asset frame */
    const char *const *tags; /* of its sensors, as they stand in the file */
    size_t tag_count;
};
/* Writes the manifest unless it says the same already, then removes files of other keys. 0 or -errno; *removed counts. removed NULL: none
   is removed. */
int folder_finish(const char *folder, const struct folder_entry *entries, size_t count, size_t *removed);

#endif
