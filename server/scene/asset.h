/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One prepared asset file, mapped into memory and checked. Immutable; counted. Thread: any. */
#ifndef SCENE_ASSET_H
#define SCENE_ASSET_H
#include "base/log.h"
#include "protocol/asset_format.h"

struct asset {
    char *path;
    struct asset_view view;
    void *map;
    size_t bytes;
    _Atomic int refs;
};

/* NULL on failure, logged with path and reason. */
struct asset *asset_open(struct log *log, const char *path);
struct asset *asset_ref(struct asset *asset);
void asset_unref(struct asset **asset); /* &NULL is fine; leaves NULL */

#endif
