/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes the read plan of a Modbus source: sorts its tags by register address, and divides them into blocks at gaps and at the
   protocol's limits. */
#include "value/read_plan.h"

#include <assert.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "value/decode.h"

struct register_place { /* register address of a tag; tags are sorted by these members, in order of declaration */
    int unit, table, scan_ms, first, end, tag;
};

static struct register_place place_of(const struct plant *plant, int tag_index)
{
    const struct plant_tag *tag = &plant->tags[tag_index];
    return (struct register_place){
        .unit = plant_tag_modbus_unit(plant, tag),
        .table = (int)tag->signal.table,
        .scan_ms = plant_tag_scan_ms(plant, tag),
        .first = tag->signal.register_index,
        .end = tag->signal.register_index + decode_width(tag),
        .tag = tag_index,
    };
}

static int by_place(const void *pa, const void *pb)
{
    int a[6], b[6], order = 0;
    memcpy(a, pa, sizeof(a));
    memcpy(b, pb, sizeof(b));
    for (int i = 0; i < 6 && order == 0; i++)
        order = (a[i] > b[i]) - (a[i] < b[i]);
    return order;
}

static int limit_of(const struct plant_source *source, int table)
{
    return table == TABLE_COIL || table == TABLE_DISCRETE ? source->max_bits : source->max_registers;
}

static bool fits(const struct read_plan_block *block, const struct register_place *place, const struct plant_source *source)
{
    return block->unit == place->unit && (int)block->table == place->table && block->scan_ms == place->scan_ms &&
           place->first <= block->first + block->count + source->max_gap && place->end - block->first <= limit_of(source, place->table);
}

static void stretch(struct read_plan_block *block, int end)
{
    if (end > block->first + block->count)
        block->count = end - block->first;
}

static void add_place(struct read_plan *plan, const struct register_place *place, const struct plant_source *source)
{
    struct read_plan_block *last = plan->block_count ? &plan->blocks[plan->block_count - 1] : NULL;
    if (!last || !fits(last, place, source)) {
        mem_grow(&plan->blocks, &plan->block_capacity, plan->block_count + 1, sizeof(*plan->blocks));
        if (plan->unit_count == 0 || plan->units[plan->unit_count - 1] != place->unit)
            plan->units[plan->unit_count++] = place->unit;
        last = &plan->blocks[plan->block_count++];
        *last = (struct read_plan_block){
            .unit = place->unit,
            .table = (enum register_table)place->table,
            .scan_ms = place->scan_ms,
            .first = place->first,
            .first_tag = plan->tag_count,
        };
    }
    stretch(last, place->end);
    last->tag_count++;
    plan->tags[plan->tag_count++] = place->tag;
}

void read_plan_init(struct read_plan *plan, const struct plant *plant, int source)
{
    struct register_place *places = mem_array(plant->tag_count, sizeof(*places));
    size_t count = 0;
    for (size_t i = 0; i < plant->tag_count; i++)
        if (plant->tags[i].source == source)
            places[count++] = place_of(plant, (int)i);
    qsort(places, count, sizeof(*places), by_place);
    *plan = (struct read_plan){ .tags = mem_array(count, sizeof(*plan->tags)), .units = mem_array(count, sizeof(*plan->units)) };
    for (size_t i = 0; i < count; i++)
        add_place(plan, &places[i], &plant->sources[source]);
    mem_free(places);
}

void read_plan_finish(struct read_plan *plan)
{
    mem_free(plan->tags);
    mem_free(plan->blocks);
    mem_free(plan->units);
    *plan = (struct read_plan){ 0 };
}

/* Sets the register range of a block to the range that its tags occupy. */
static void fit_to_tags(struct read_plan_block *block, const struct read_plan *plan, const struct plant *plant)
{
    block->first = plant->tags[plan->tags[block->first_tag]].signal.register_index;
    block->count = 0;
    for (size_t i = 0; i < block->tag_count; i++) {
        const struct plant_tag *tag = &plant->tags[plan->tags[block->first_tag + i]];
        stretch(block, tag->signal.register_index + decode_width(tag));
    }
}

void read_plan_split(struct read_plan *plan, const struct plant *plant, size_t index)
{
    assert(plan->blocks[index].tag_count >= 2);
    mem_grow(&plan->blocks, &plan->block_capacity, plan->block_count + 1, sizeof(*plan->blocks));
    memmove(&plan->blocks[index + 1], &plan->blocks[index], (plan->block_count - index) * sizeof(*plan->blocks));
    plan->block_count++;
    struct read_plan_block *left = &plan->blocks[index], *right = left + 1;
    left->tag_count /= 2;
    right->first_tag += left->tag_count;
    right->tag_count -= left->tag_count;
    fit_to_tags(left, plan, plant);
    fit_to_tags(right, plan, plant);
}
