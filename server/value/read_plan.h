/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Read plan of a Modbus source: its tags, grouped into blocks; one request reads one block. No input or output, no clock. Call from
   one thread only. */
#ifndef VALUE_READ_PLAN_H
#define VALUE_READ_PLAN_H
#include <stddef.h>
#include <stdint.h>

#include "plant/plant.h"

/* maximum number of registers, or of bits, in one request (Modbus Application Protocol 6.1-6.4) */
enum { READ_PLAN_MAX_REGISTERS = 125, READ_PLAN_MAX_BITS = 2000 };

/* a block: the tags that one request to the device reads. Gaps between their registers are at most the source's max_gap registers. */
struct read_plan_block {
    int unit; /* Modbus unit identifier */
    enum register_table table;
    int scan_ms;
    int first, count;            /* registers or bits */
    size_t first_tag, tag_count; /* index of the first tag in read_plan.tags, and number of tags */
    /* monotonic time of the block's next read. modbus.c sets it; 0 in a new plan; read_plan_split() copies it */
    int64_t due_ns;
    /* modbus.c sets the following members, too. They are 0 in a new plan, and read_plan_split() copies them. */
    int busy_count; /* number of consecutive responses in which the device reports that it is busy */
    /* number of consecutive responses in which the device refuses the block; counted only for blocks with a single tag */
    int refused_count;
    int silent_count; /* number of consecutive requests without an answer while other blocks of the unit were answered */
    bool answered;    /* the last request was answered */
};

struct read_plan { /* zero-initialise */
    int *tags;     /* indices in plant->tags of the source's tags, sorted by register address; each block has a range of these indices */
    size_t tag_count;
    struct read_plan_block *blocks;
    size_t block_count, block_capacity;
    int *units; /* numbers of the Modbus units (slave addresses) in the plan, each once */
    size_t unit_count;
};

/* Builds the read plan of one Modbus source. Keeps no pointer to the plant. Free with read_plan_finish(). */
void read_plan_init(struct read_plan *plan, const struct plant *plant, int source);
void read_plan_finish(struct read_plan *plan);
/* Splits a block of at least two tags in two; the second one gets the index block + 1. */
void read_plan_split(struct read_plan *plan, const struct plant *plant, size_t index);

#endif
