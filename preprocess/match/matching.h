/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One run of `plantcast match`: a plant's folder and an export of tags become plant.yaml, tags.csv and matches.csv. Thread: one. */
#ifndef PREPROCESS_MATCH_MATCHING_H
#define PREPROCESS_MATCH_MATCHING_H
#include <stdbool.h>
#include <stddef.h>

struct matching_params {
    const char *plant;            /* the plant file */
    const char *tags;             /* the export */
    const char *encoding;         /* of the export; NULL: it is found */
    const char *decisions;        /* what people decided, beside matches.csv, and before it; NULL: nothing */
    const char *const *equipment; /* what becomes an asset (equipment.h); none: the plant file's assets stay */
    int equipment_count;
    const char *source;     /* id; NULL: the only one, or `plc` where --modbus makes it */
    const char *modbus;     /* HOST or HOST:PORT of a source that is to be made, or that was made so and is elsewhere now; NULL: none */
    int unit;               /* of that source: unit identifier; -1: none is stated */
    const char *byte_order; /* of that source; NULL: none */
    int address_base;       /* likewise */
    int lent;               /* plant_folder.h */
    int timeout_s;          /* of reading and matching, in a confined process */
    size_t memory_bytes;    /* of the same */
    bool dry_run;           /* says what it found, and writes nothing */
};

/* Returns the exit status: 0, or 1 with one line on standard error for each thing that is wrong; then nothing was written. */
int matching_run(const struct matching_params *params);

#endif
