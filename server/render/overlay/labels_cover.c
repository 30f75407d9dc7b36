/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the position of the only call-out of a frame, a label for all alarm rings, at which it covers the fewest rings. */
#include <math.h>

#include "base/mem.h"
#include "render/overlay/labels_impl.h"

/* positions: a grid over the area. FINE: its step in units (pixels at 1280x720); MOST_FINE: maximum number of steps to each side, which
   limits time and memory. */
enum { FINE = 4, MOST_FINE = 512 };
static const double BLOCKED = 1e9; /* weight of a position at which the label covers a blocked box; more than the number of rings */

struct fine_grid {
    const struct label_box *area;
    double step, width, height; /* width, height: size of the label */
    int columns, rows;
    /* table of (rows + 1) x (columns + 1). cover() adds the weight of a rectangle of positions to its four corners; sums over the table
       then give the weight of each position. Therefore the time does not grow with the product of positions and boxes. */
    double *sums;
};

/* Returns the number of positions in a direction; 0 or less if the label is larger than the area. */
static int count_of(double room, double step)
{
    return (int)fmax(-1, fmin(MOST_FINE, floor(room / step))) + 1;
}

static int first_of(double low, const struct fine_grid *grid)
{
    return (int)fmin(MOST_FINE + 1, fmax(0, floor(low / grid->step) + 1));
}

static int end_of(double high, const struct fine_grid *grid, int most)
{
    return (int)fmax(0, fmin(most, ceil(high / grid->step)));
}

/* Adds a weight to all positions at which the label overlaps a box. */
static void cover(struct fine_grid *grid, const struct label_box *box, double weight)
{
    int left = first_of(box->x - grid->area->x - grid->width, grid), top = first_of(box->y - grid->area->y - grid->height, grid);
    int right = end_of(box->x + box->width - grid->area->x, grid, grid->columns);
    int bottom = end_of(box->y + box->height - grid->area->y, grid, grid->rows), across = grid->columns + 1;
    if (left >= right || top >= bottom)
        return;
    grid->sums[top * across + left] += weight;
    grid->sums[top * across + right] -= weight;
    grid->sums[bottom * across + left] -= weight;
    grid->sums[bottom * across + right] += weight;
}

static double squared(double x)
{
    return x * x;
}

/* Returns the index of the position with the least weight, the nearest to the centre of the call-out's rings of several; LABEL_NONE: the
   label covers a blocked box at every position. */
static int best_position(struct fine_grid *grid, const struct label_item *group)
{
    double least = BLOCKED, nearest = INFINITY;
    int best = LABEL_NONE;
    for (int row = 0; row < grid->rows; row++)
        for (int column = 0; column < grid->columns; column++) {
            double *at = &grid->sums[row * (grid->columns + 1) + column], *above = at - grid->columns - 1;
            *at += (column ? at[-1] : 0) + (row ? above[0] : 0) - (row && column ? above[-1] : 0);
            int index = row * grid->columns + column;
            double x = grid->area->x + column * grid->step + grid->width / 2, y = grid->area->y + row * grid->step + grid->height / 2;
            double away = (group->held == LABEL_FORCED + 1 + index ? squared(LABEL_HELD_FACTOR) : 1) *
                          (squared(x - group->x) + squared(y - group->y));
            if (*at > least || (*at == least && away >= nearest) || *at >= BLOCKED)
                continue;
            least = *at;
            nearest = away;
            best = index;
        }
    return best;
}

/* Returns the box of the call-out centred on its rings and moved into the area. */
static struct label_box forced_box(const struct label_box *area, const struct label_item *group)
{
    return (struct label_box){ fmax(area->x, fmin(area->x + area->width - group->width, group->x - group->width / 2)),
                               fmax(area->y, fmin(area->y + area->height - group->height, group->y - group->height / 2)), group->width,
                               group->height };
}

int layout_cover_least(const struct label_layout *layout, const struct label_item *group, struct label_box *box)
{
    const struct label_area *area = layout->area;
    double longest = fmax(area->box.width, area->box.height), step = fmax(fmin(FINE * area->unit, longest), longest / MOST_FINE);
    struct fine_grid grid = { &area->box,
                              step,
                              group->width,
                              group->height,
                              count_of(area->box.width - group->width, step),
                              count_of(area->box.height - group->height, step),
                              NULL };
    int index = LABEL_NONE;
    if (grid.columns > 0 && grid.rows > 0) {
        grid.sums = mem_array((size_t)(grid.columns + 1) * (size_t)(grid.rows + 1), sizeof(*grid.sums));
        for (size_t i = 0; i < area->blocked_count; i++)
            cover(&grid, &area->blocked[i], BLOCKED);
        for (size_t i = 0; i < layout->item_count; i++) {
            const struct label_item *item = &layout->items[i];
            double radius = (LABEL_RING_UNITS + LABEL_CLEARANCE) * area->unit;
            if (item->ring)
                cover(&grid, &(struct label_box){ item->x - radius, item->y - radius, 2 * radius, 2 * radius }, 1);
        }
        index = best_position(&grid, group);
        mem_free(grid.sums);
    }
    *box = forced_box(&area->box, group);
    if (index != LABEL_NONE)
        *box = (struct label_box){ area->box.x + index % grid.columns * step, area->box.y + index / grid.columns * step, group->width,
                                   group->height };
    return index == LABEL_NONE ? LABEL_FORCED : LABEL_FORCED + 1 + index;
}
