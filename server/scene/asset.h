/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One prepared asset file, mapped into memory and checked. Immutable; reference-counted. Call from any thread. */
#ifndef SCENE_ASSET_H
#define SCENE_ASSET_H
#include "base/log/log.h"
#include "protocol/asset_format.h"
#include "base/files/cache_file.h"
#include "protocol/influence_format.h"
#include "scene/closed_bodies.h"

struct asset {
    char *path;
    struct asset_view view;
    void *map; /* mapped file; NULL: the asset was built in memory, see `made` */
    void *made;
    uint16_t *distances; /* distances unpacked from the file; NULL: the file stores them unpacked */
    size_t bytes;
    /* mapped file KEY.influence from the folder of the asset's file, with the influence of each sensor on each vertex; all
       zero: not opened */
    struct cache_file influence_file;
    struct influence_view influence;
    /* bit mask of levels of detail whose triangles plantcast-prep has subdivided until interpolating within them causes no
       visible error of the field (field/drawn_error.h) */
    uint64_t resolved_levels;
    /* true: triangles were cut for other parameters or sensors than those of the plant file, so no level counts as resolved */
    bool cuts_differ;
    _Atomic int refs;
    /* by level of detail: triangles that bound closed bodies, whose cuts are drawn solid (closed_bodies.h); NULL: not computed yet */
    struct closed_bodies *_Atomic *closed;
};

/* Opens a file. On failure, logs path and reason and returns NULL. */
struct asset *asset_open(struct log *log, const char *path);
/* Maps and checks the file KEY.influence next to the asset's file, unless it is open already. Logs and returns false if there
   is no valid file. Call from one thread only, before others use the asset. */
bool asset_open_influence(struct log *log, struct asset *asset);
/* Returns an asset to use in place of one that could not be prepared: it has one triangle, too small to be visible, and no
   sensors. */
struct asset *asset_stand_in(void);
struct asset *asset_ref(struct asset *asset);
void asset_unref(struct asset **asset);        /* releases the asset and sets *asset to NULL; accepts a pointer to NULL */
void asset_forget_closed(struct asset *asset); /* frees the closed bodies; pointers from asset_closed() are then invalid */
/* Returns the closed bodies of a level of detail. The first call computes them, in a few milliseconds per 100,000 triangles. Owned by the
   asset. */
const struct closed_bodies *asset_closed(const struct asset *asset, uint32_t level);

#endif
