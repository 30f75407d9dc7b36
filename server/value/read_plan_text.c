/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints the read plan of a Modbus source as text. */
#include "value/read_plan_text.h"

#include <string.h>

#include "plant/sources/address.h"
#include "value/decode.h"
#include "value/read_plan.h"

static const struct {
    const char *prefix;
    int function;
} tables[] = { [TABLE_COIL] = { "co", 1 }, [TABLE_DISCRETE] = { "di", 2 }, [TABLE_INPUT] = { "ir", 4 }, [TABLE_HOLDING] = { "hr", 3 } };

static const char *order_name(enum byte_order order)
{
    static const char *const names[] = { "", "ABCD", "CDAB", "BADC", "DCBA" };
    return names[order];
}

static bool of_bits(const struct read_plan_block *block)
{
    return block->table == TABLE_COIL || block->table == TABLE_DISCRETE;
}

/* Returns the number of bytes on the wire of the request for a block, and of its response. */
static double bytes_of(const struct plant_source *source, const struct read_plan_block *block)
{
    int values = of_bits(block) ? (block->count + 7) / 8 : 2 * block->count;
    return source->transport == TRANSPORT_TCP ? 12 + 9 + values : 8 + 5 + values;
}

static void add_way(struct text *out, const struct plant_source *source)
{
    text_add(out, "source %s: ", source->id);
    if (source->transport == TRANSPORT_RTU)
        text_add(out, "%s, %d baud, parity %c, %d stop bit%s", source->device, source->baud, source->parity, source->stop_bits,
                 source->stop_bits == 1 ? "" : "s");
    for (int i = 0; i < source->host_count; i++)
        text_add(out, "%s%s:%d%s", i ? ", else " : "", source->hosts[i], source->port,
                 source->transport == TRANSPORT_RTU_TCP ? " (RTU over TCP)" : "");
}

static void add_block(struct text *out, const struct read_plan *plan, const struct plant *plant, const struct read_plan_block *block)
{
    text_add(out, "  unit %d, function %d, %s:%d to %d: %d %s%s every %d ms, %zu tag%s\n", block->unit, tables[block->table].function,
             tables[block->table].prefix, block->first, block->first + block->count - 1, block->count, of_bits(block) ? "bit" : "register",
             block->count == 1 ? "" : "s", block->scan_ms, block->tag_count, block->tag_count == 1 ? "" : "s");
    for (size_t i = 0; i < block->tag_count; i++) {
        const struct plant_tag *tag = &plant->tags[plan->tags[block->first_tag + i]];
        text_add(out, "    %s:%d", tables[tag->signal.table].prefix, tag->signal.register_index);
        if (tag->signal.bit >= 0)
            text_add(out, ".%d", tag->signal.bit);
        text_add(out, " %s%s%s %s\n", data_type_name(tag->signal.type), tag->signal.byte_order ? " " : "",
                 order_name(tag->signal.byte_order), tag->name);
    }
}

static void add_load(struct text *out, const struct read_plan *plan, const struct plant_source *source)
{
    double requests = 0, values = 0, bytes = 0;
    for (size_t i = 0; i < plan->block_count; i++) {
        const struct read_plan_block *block = &plan->blocks[i];
        double per_s = 1000.0 / block->scan_ms;
        requests += per_s;
        values += per_s * (double)block->tag_count;
        bytes += per_s * bytes_of(source, block);
    }
    text_add(out, "  load: %.4g requests, %.4g values and %.4g bytes per second", requests, values, bytes);
    if (source->pause_ms > 0)
        text_add(out, "; waiting `pause_ms` after each answer takes %.3g %% of the time", requests * source->pause_ms / 10);
    /* Share of a serial line's capacity. A byte takes a start bit, 8 data bits, the parity bit and the stop bits; a pause of
       3.5 bytes separates frames. */
    if (source->transport == TRANSPORT_RTU) {
        double bits = 1 + 8 + (source->parity != 'N') + source->stop_bits, part = (bytes + 7 * requests) * bits / source->baud;
        text_add(out, "; %.3g %% of the serial line's capacity%s", part * 100,
                 part > 1 ? ": TOO MUCH, so readings will be late: read fewer tags, or read them less often" : "");
    }
    text_add(out, "\n");
}

void read_plan_text(struct text *out, const struct plant *plant, int source_index)
{
    const struct plant_source *source = &plant->sources[source_index];
    struct read_plan plan;
    if (strcmp(source->kind, "modbus") != 0) {
        size_t tags = 0;
        for (size_t i = 0; i < plant->tag_count; i++)
            tags += plant->tags[i].source == source_index;
        add_way(out, source);
        text_add(out, "%s%s: %s %zu tag%s\n", source->host_count > 0 ? ": " : "", source->kind,
                 source->host_count > 0 ? "subscribes to" : "no requests, replays", tags, tags == 1 ? "" : "s");
        return;
    }
    read_plan_init(&plan, plant, source_index);
    add_way(out, source);
    text_add(out, ": %zu tags in %zu request%s\n", plan.tag_count, plan.block_count, plan.block_count == 1 ? "" : "s");
    for (size_t i = 0; i < plan.block_count; i++)
        add_block(out, &plan, plant, &plan.blocks[i]);
    add_load(out, &plan, source);
    read_plan_finish(&plan);
}
