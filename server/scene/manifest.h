/* SPDX-License-Identifier: GPL-3.0-or-later */
/* FOLDER/manifest.json: which prepared file belongs to which asset (protocol/ASSET.md). Thread: one. */
#ifndef SCENE_MANIFEST_H
#define SCENE_MANIFEST_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log/log.h"

struct manifest {
    char *path;
    struct manifest_entry {
        char *id, *file; /* file: a name in the same folder */
        char *surface;   /* likewise, surface_store.h; NULL: none was kept */
        char *missing;   /* why it could not be prepared, and has no file; NULL: it has */
        uint64_t recipe; /* plant/recipe.h */
        uint64_t resolved_levels; /* struct asset's */
    } *entries;
    size_t count;
};

/* False: logged, with what to do about it. */
bool manifest_read(struct log *log, const char *folder, struct manifest *manifest);
void manifest_finish(struct manifest *manifest);
const struct manifest_entry *manifest_find(const struct manifest *manifest, const char *id); /* or NULL */

#endif
