/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Groups overlapping boxes by recursively halving space. The recursion ends in a cell with few boxes, or whose boxes already
 * form one group, or that is filled by a box, which then overlaps all others. A sweep along one axis, the usual method, would
 * compare all pairs of boxes along a plate perpendicular to that axis. */
#include "preprocess/levels/box_groups.h"

#include <math.h>
#include <stdbool.h>

#include "base/mem.h"
#include "surface/mesh/trimesh.h"

#define FEW 24       /* maximum number of boxes in a cell for which all pairs are compared */
#define MAX_DEPTH 96 /* maximum recursion depth: 24 bits of precision on each of three axes, plus a margin */

struct box_cell {
    float low_m[3], high_m[3];
};

static bool meet(const struct part_box *a, const struct part_box *b)
{
    for (int axis = 0; axis < 3; axis++)
        if (a->high_m[axis] < b->low_m[axis] || b->high_m[axis] < a->low_m[axis])
            return false;
    return true;
}

static void join_each(const struct part_box *boxes, const uint32_t *list, size_t count, uint32_t *parent)
{
    for (size_t i = 0; i < count; i++)
        for (size_t j = i + 1; j < count; j++)
            if (meet(&boxes[list[i]], &boxes[list[j]]))
                trimesh_join(parent, boxes[list[i]].part, boxes[list[j]].part);
}

static bool are_one_group(const struct part_box *boxes, const uint32_t *list, size_t count, uint32_t *parent)
{
    uint32_t root = trimesh_root(parent, boxes[list[0]].part);
    for (size_t i = 1; i < count; i++)
        if (trimesh_root(parent, boxes[list[i]].part) != root)
            return false;
    return true;
}

/* Shrinks the cell to the bounding box of its boxes. */
static void tighten(const struct part_box *boxes, const uint32_t *list, size_t count, struct box_cell *cell)
{
    for (int axis = 0; axis < 3; axis++) {
        float low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < count; i++) {
            low = fminf(low, boxes[list[i]].low_m[axis]);
            high = fmaxf(high, boxes[list[i]].high_m[axis]);
        }
        cell->low_m[axis] = fmaxf(cell->low_m[axis], low);
        cell->high_m[axis] = fminf(cell->high_m[axis], high);
    }
}

static bool holds(const struct part_box *box, const float low_m[3], const float high_m[3])
{
    for (int axis = 0; axis < 3; axis++)
        if (box->low_m[axis] > low_m[axis] || box->high_m[axis] < high_m[axis])
            return false;
    return true;
}

/* Groups boxes that certainly overlap, without comparing pairs. If one box fills the cell, groups all boxes of the cell; otherwise groups
 * those that contain the cell's centre. Returns whether all boxes were grouped. */
static bool join_some(const struct part_box *boxes, const uint32_t *list, size_t count, const struct box_cell *cell, uint32_t *parent)
{
    float middle_m[3];
    size_t filler = 0, first = count;
    for (int axis = 0; axis < 3; axis++)
        middle_m[axis] = 0.5f * (cell->low_m[axis] + cell->high_m[axis]);
    while (filler < count && !holds(&boxes[list[filler]], cell->low_m, cell->high_m))
        filler++;
    for (size_t i = 0; i < count; i++) {
        if (filler == count && !holds(&boxes[list[i]], middle_m, middle_m))
            continue;
        first = first == count ? i : first;
        trimesh_join(parent, boxes[list[first]].part, boxes[list[i]].part);
    }
    return filler < count;
}

/* Returns the axis along which to halve the cell: the one with the fewest boxes in both halves; -1: halving along no axis helps. */
static int best_axis(const struct part_box *boxes, const uint32_t *list, size_t count, const struct box_cell *cell)
{
    int best = -1;
    size_t least = 2 * count;
    for (int axis = 0; axis < 3; axis++) {
        float middle = 0.5f * (cell->low_m[axis] + cell->high_m[axis]);
        size_t both = 0;
        if (!(middle > cell->low_m[axis] && middle < cell->high_m[axis]))
            continue;
        for (size_t i = 0; i < count; i++)
            both += (size_t)(boxes[list[i]].low_m[axis] <= middle) + (size_t)(boxes[list[i]].high_m[axis] >= middle);
        if (both < least) {
            least = both;
            best = axis;
        }
    }
    return best;
}

static void join_in(const struct part_box *boxes, uint32_t *list, size_t count, struct box_cell cell, int depth, uint32_t *parent);

static void join_half(const struct part_box *boxes, const uint32_t *list, size_t count, const struct box_cell *half, int axis, int depth,
                      uint32_t *parent)
{
    uint32_t *inside = mem_array(count, sizeof(*inside));
    size_t inside_count = 0;
    for (size_t i = 0; i < count; i++)
        if (boxes[list[i]].low_m[axis] <= half->high_m[axis] && boxes[list[i]].high_m[axis] >= half->low_m[axis])
            inside[inside_count++] = list[i];
    join_in(boxes, inside, inside_count, *half, depth + 1, parent);
    mem_free(inside);
}

/* Groups the overlapping boxes of a cell by recursively halving the cell. Two overlapping boxes have a common point, so the
 * half that contains this point has both boxes, and the overlap is found there. */
static void join_in(const struct part_box *boxes, uint32_t *list, size_t count, struct box_cell cell, int depth, uint32_t *parent)
{
    if (count < 2 || are_one_group(boxes, list, count, parent))
        return;
    tighten(boxes, list, count, &cell);
    if (join_some(boxes, list, count, &cell, parent) || are_one_group(boxes, list, count, parent))
        return;
    int axis = count <= FEW || depth >= MAX_DEPTH ? -1 : best_axis(boxes, list, count, &cell);
    if (axis < 0) {
        join_each(boxes, list, count, parent);
        return;
    }
    struct box_cell lower = cell, upper = cell;
    lower.high_m[axis] = upper.low_m[axis] = 0.5f * (cell.low_m[axis] + cell.high_m[axis]);
    join_half(boxes, list, count, &lower, axis, depth, parent);
    join_half(boxes, list, count, &upper, axis, depth, parent);
}

void box_groups_join(const struct part_box *boxes, size_t count, uint32_t *parent)
{
    struct box_cell all = { { -INFINITY, -INFINITY, -INFINITY }, { INFINITY, INFINITY, INFINITY } };
    uint32_t *list = mem_array(count, sizeof(*list));
    for (size_t i = 0; i < count; i++)
        list[i] = (uint32_t)i;
    join_in(boxes, list, count, all, 0, parent);
    mem_free(list);
}
