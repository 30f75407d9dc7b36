/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which boxes hang together: those that meet, and what meets these. Thread: any. */
#ifndef PREPROCESS_LEVELS_BOX_GROUPS_H
#define PREPROCESS_LEVELS_BOX_GROUPS_H
#include <stddef.h>
#include <stdint.h>

struct box {
    float low_m[3], high_m[3]; /* boxes that only touch meet, too */
    uint32_t part;
};

/* Joins (trimesh_join) the parts of boxes that meet, in time that grows little faster than their number, however they lie. */
void box_groups_join(const struct box *boxes, size_t count, uint32_t *parent);

#endif
