/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds materials with equal colour ramps (a material's colours from dark to bright) by sorting the rows of the ramp tables. Of
   equal rows, only the first is stored. */
#include "render/soft/ramp_rows.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

/* number of bits in one colour channel; as the value of ramp_search.bits: materials count as equal only if all bits of all
   their colours are equal */
enum { WHOLE = 8 };

struct ramp_search {
    const uint32_t *muted, *own;
    size_t steps;
    /* how ramp rows are compared: WHOLE: by all their colours; a smaller number: by this many bits per channel of each row's brightest
       colour */
    int bits;
};

static int by_number(uint32_t a, uint32_t b)
{
    return (a > b) - (a < b);
}

static uint32_t brightest(const struct ramp_search *rows, const uint32_t *colors, uint32_t row)
{
    return colors[(row + 1) * rows->steps - 1] & (0x010101u * (0xffu & ~0u << (WHOLE - rows->bits)));
}

static int by_look(const struct ramp_search *rows, uint32_t a, uint32_t b)
{
    if (rows->bits < WHOLE)
        return by_number(brightest(rows, rows->own, a), brightest(rows, rows->own, b));
    size_t bytes = rows->steps * sizeof(uint32_t);
    int order = memcmp(rows->own + a * rows->steps, rows->own + b * rows->steps, bytes);
    return order ? order : memcmp(rows->muted + a * rows->steps, rows->muted + b * rows->steps, bytes);
}

static int compare(const void *a, const void *b, void *arg)
{
    uint32_t one = *(const uint32_t *)a, other = *(const uint32_t *)b;
    int order = by_look(arg, one, other);
    return order ? order : by_number(one, other);
}

/* Writes, for each row of the colour ramps (one per material), the index of the first row with equal colours. Returns the
   number of distinct rows. */
static size_t find_first(const struct ramp_search *rows, size_t count, uint32_t *order, uint32_t *first)
{
    size_t different = 0;
    for (size_t i = 0; i < count; i++)
        order[i] = (uint32_t)i;
    qsort_r(order, count, sizeof(*order), compare, (void *)rows);
    for (size_t i = 0; i < count; i++) {
        bool is_new = i == 0 || by_look(rows, order[i - 1], order[i]) != 0;
        different += is_new;
        first[order[i]] = is_new ? order[i] : first[order[i - 1]];
    }
    return different;
}

size_t ramp_rows_pack(uint32_t *muted, uint32_t *own, size_t count, size_t steps, size_t most, uint32_t *row_of_material)
{
    struct ramp_search rows = { .muted = muted, .own = own, .steps = steps, .bits = WHOLE };
    uint32_t *order = mem_array(count, sizeof(*order)), *first = mem_array(count, sizeof(*first));
    while (find_first(&rows, count, order, first) > most && rows.bits > 1)
        rows.bits--;
    size_t packed = 0;
    for (size_t i = 0; i < count; i++) {
        /* an earlier material has an equal colour ramp (colours from dark to bright), whose row is already in the packed table */
        if (first[i] != i) {
            row_of_material[i] = row_of_material[first[i]];
            continue;
        }
        memmove(own + packed * steps, own + i * steps, steps * sizeof(*own));
        memmove(muted + packed * steps, muted + i * steps, steps * sizeof(*muted));
        row_of_material[i] = (uint32_t)packed++;
    }
    mem_free(order);
    mem_free(first);
    return packed;
}
