/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares two frames tile by tile, and covers the tiles that differ with rectangles. */
#include "encode/dirty_rects.h"

#include <string.h>

#include "base/mem.h"

/* cost of one more rectangle, given as a number of pixels: its header and tables take as many bytes as that many encoded pixels */
static const long PART_COST_PX = 4096;

static const uint8_t *row(const struct frame *frame, int x_px, int y_px)
{
    return frame->bgrx + (size_t)y_px * (size_t)frame->stride_bytes + (size_t)x_px * 4;
}

bool dirty_rects_none(const struct frame *before, const struct frame *now)
{
    for (int y = 0; y < now->height_px; y++)
        if (memcmp(row(before, 0, y), row(now, 0, y), (size_t)now->width_px * 4) != 0)
            return false;
    return true;
}

static int least(int a, int b)
{
    return a < b ? a : b;
}

static int most(int a, int b)
{
    return a > b ? a : b;
}

static bool tile_differs(const struct frame *before, const struct frame *now, int x_px, int y_px)
{
    size_t bytes = (size_t)least(DIRTY_RECTS_TILE_PX, now->width_px - x_px) * 4;
    int end_px = least(y_px + DIRTY_RECTS_TILE_PX, now->height_px);
    for (int y = y_px; y < end_px; y++)
        if (memcmp(row(before, x_px, y), row(now, x_px, y), bytes) != 0)
            return true;
    return false;
}

static struct dirty_rect around(const struct dirty_rect *a, const struct dirty_rect *b)
{
    int right = most(a->x_px + a->width_px, b->x_px + b->width_px), low = most(a->y_px + a->height_px, b->y_px + b->height_px);
    struct dirty_rect all = { .x_px = least(a->x_px, b->x_px), .y_px = least(a->y_px, b->y_px) };
    all.width_px = right - all.x_px;
    all.height_px = low - all.y_px;
    return all;
}

static long area(const struct dirty_rect *change)
{
    return (long)change->width_px * change->height_px;
}

static bool overlap(const struct dirty_rect *a, const struct dirty_rect *b)
{
    return a->x_px < b->x_px + b->width_px && b->x_px < a->x_px + a->width_px && a->y_px < b->y_px + b->height_px &&
           b->y_px < a->y_px + a->height_px;
}

/* Returns the cost in pixels of replacing two rectangles by one that encloses both; negative: one rectangle is cheaper. */
static long growth(const struct dirty_rect *a, const struct dirty_rect *b)
{
    struct dirty_rect all = around(a, b);
    return overlap(a, b) ? -1 : area(&all) - area(a) - area(b) - PART_COST_PX;
}

struct rect_list {
    struct dirty_rect *at;
    size_t count, capacity;
};

/* Adds a horizontal run of differing tiles, or extends the rectangle directly above by it if that has the same left edge and width. */
static void add_run(struct rect_list *list, const struct dirty_rect *run)
{
    for (size_t i = 0; i < list->count; i++) {
        struct dirty_rect *above = &list->at[i];
        if (above->x_px == run->x_px && above->width_px == run->width_px && above->y_px + above->height_px == run->y_px) {
            above->height_px += run->height_px;
            return;
        }
    }
    mem_grow(&list->at, &list->capacity, list->count + 1, sizeof(*list->at));
    list->at[list->count++] = *run;
}

static void find_runs(const struct frame *before, const struct frame *now, struct rect_list *list)
{
    for (int y = 0; y < now->height_px; y += DIRTY_RECTS_TILE_PX) {
        struct dirty_rect run = { .y_px = y, .height_px = least(DIRTY_RECTS_TILE_PX, now->height_px - y) };
        for (int x = 0; x < now->width_px; x += DIRTY_RECTS_TILE_PX) {
            int width_px = least(DIRTY_RECTS_TILE_PX, now->width_px - x);
            if (tile_differs(before, now, x, y)) {
                run.x_px = run.width_px ? run.x_px : x;
                run.width_px += width_px;
            } else if (run.width_px) {
                add_run(list, &run);
                run.width_px = 0;
            }
        }
        if (run.width_px)
            add_run(list, &run);
    }
}

/* Finds the pair of rectangles that is cheapest to merge (growth()); *a and *b receive their indices. Returns the cost. */
static long cheapest(const struct rect_list *list, size_t *a, size_t *b)
{
    long best = 0;
    *a = *b = 0;
    for (size_t i = 0; i < list->count; i++)
        for (size_t j = i + 1; j < list->count; j++) {
            long more = growth(&list->at[i], &list->at[j]);
            if (*b && more >= best)
                continue;
            best = more;
            *a = i;
            *b = j;
        }
    return best;
}

static void merge(struct rect_list *list, size_t a, size_t b)
{
    list->at[a] = around(&list->at[a], &list->at[b]);
    list->at[b] = list->at[--list->count];
}

/* Merges adjacent rectangles of the list until at most `enough` remain, so that the quadratic search for the best pair stays cheap. */
static void thin(struct rect_list *list, size_t enough)
{
    for (size_t i = 0; i + 1 < list->count && list->count > enough;)
        if (growth(&list->at[i], &list->at[i + 1]) < (long)DIRTY_RECTS_TILE_PX * DIRTY_RECTS_TILE_PX * 16)
            merge(list, i, i + 1);
        else
            i++;
    while (list->count > enough)
        merge(list, list->count - 2, list->count - 1);
}

int dirty_rects_find(const struct frame *before, const struct frame *now, struct dirty_rect out[DIRTY_RECTS_MAX])
{
    struct rect_list list = { 0 };
    size_t a, b;
    find_runs(before, now, &list);
    thin(&list, 64);
    while (list.count > 1 && (cheapest(&list, &a, &b) < 0 || list.count > DIRTY_RECTS_MAX)) {
        cheapest(&list, &a, &b);
        merge(&list, a, b);
    }
    int count = (int)list.count;
    if (count)
        memcpy(out, list.at, list.count * sizeof(*out));
    mem_free(list.at);
    return count;
}

double dirty_rects_share(const struct frame *frame, const struct dirty_rect *rects, int count)
{
    double pixels = 0;
    for (int i = 0; i < count; i++)
        pixels += (double)area(&rects[i]);
    return pixels / ((double)frame->width_px * frame->height_px);
}
