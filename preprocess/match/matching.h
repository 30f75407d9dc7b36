/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs `plantcast match` once: reads a plant's folder and an export of tags, and writes plant.yaml, tags.csv and matches.csv.
 * Call from one thread only. */
#ifndef PREPROCESS_MATCH_MATCHING_H
#define PREPROCESS_MATCH_MATCHING_H
#include <stdbool.h>
#include <stddef.h>

struct matching_params {
    const char *plant;            /* path of the plant file */
    const char *tags;             /* path of the exported tag list */
    const char *encoding;         /* encoding of the exported tag list; NULL: detect it */
    const char *decisions;        /* path of a file of people's decisions, which override matches.csv; NULL: none */
    const char *const *equipment; /* selects the nodes that become assets (equipment.h); count 0: keep the plant file's assets */
    int equipment_count;
    /* plant file's id of the source that delivers the tags' values; NULL: the plant's only source, or `plc` with --modbus */
    const char *source;
    /* HOST or HOST:PORT of a Modbus source to add, or the new address of a source added by an earlier run; NULL: none */
    const char *modbus;
    int unit;               /* unit identifier of the Modbus source to add; -1: not given */
    const char *byte_order; /* byte order of the Modbus source to add; NULL: not given */
    int address_base;       /* address base of the Modbus source to add */
    int lent;               /* descriptor of a folder lock held by the parent process (plant_folder.h); 0: none */
    int timeout_s;          /* time limit for the confined child, which reads and matches, seconds */
    size_t memory_bytes;    /* memory limit of the confined child, bytes */
    bool dry_run;           /* only print the results */
};

/* Returns the exit status: 0, or 1 after printing one line per error on standard error without writing any file. */
int matching_run(const struct matching_params *params);

#endif
