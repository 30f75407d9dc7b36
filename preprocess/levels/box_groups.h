/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Groups axis-aligned boxes: boxes that overlap or touch, directly or through other boxes, are in one group. Call from any thread. */
#ifndef PREPROCESS_LEVELS_BOX_GROUPS_H
#define PREPROCESS_LEVELS_BOX_GROUPS_H
#include <stddef.h>
#include <stdint.h>

struct part_box {
    float low_m[3], high_m[3]; /* boxes that only touch count as overlapping */
    uint32_t part;
};

/* Merges the parts (connected components of a model) whose boxes overlap or touch, in the union-find forest `parent`
 * (trimesh_join()). Run time is nearly linear in the number of boxes, whatever their arrangement. */
void box_groups_join(const struct part_box *boxes, size_t count, uint32_t *parent);

#endif
