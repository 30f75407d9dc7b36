/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One prepared asset file, mapped into memory and checked. Immutable; counted. Thread: any. */
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
    void *map; /* NULL: it was made here */
    void *made;
    size_t bytes;
    struct cache_file influence_file; /* beside it; zero: none was asked for */
    struct influence_view influence;
    uint64_t resolved_levels; /* by bits: preparing cut the level's triangles until they show the field right (field/drawn_error.h) */
    _Atomic int refs;
    struct closed_bodies *_Atomic *closed; /* by level; NULL: nobody asked yet */
};

/* NULL on failure, logged with path and reason. */
struct asset *asset_open(struct log *log, const char *path);
/* Maps and checks the file KEY.influence beside the asset's, unless it is there already. Returns false if there is none that is good,
   logged. Thread: one, before others use the asset. */
bool asset_open_influence(struct log *log, struct asset *asset);
/* What stands in for one that could not be prepared: a triangle that is too small to be seen, and no sensor. */
struct asset *asset_stand_in(void);
struct asset *asset_ref(struct asset *asset);
void asset_unref(struct asset **asset);        /* &NULL is fine; leaves NULL */
void asset_forget_closed(struct asset *asset); /* nobody may use them any more */
/* Found when it is first asked for, which takes some milliseconds for each 100,000 triangles. */
const struct closed_bodies *asset_closed(const struct asset *asset, uint32_t level);

#endif
