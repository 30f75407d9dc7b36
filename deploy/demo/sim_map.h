/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Maps recorded series to tags, by `--map` arguments and map files. Call from one thread only. */
#ifndef DEMO_SIM_MAP_H
#define DEMO_SIM_MAP_H
#include <stdbool.h>
#include <stddef.h>

#include "base/text/diag.h"

struct sim_map_entry {
    char *tag, *series;
    double scale, offset;
    const char *file; /* file that contains the entry, for error messages; owned by the map */
    int line;
};

struct sim_map { /* zero-initialise */
    struct sim_map_entry *entries;
    size_t count, capacity;
    char **files; /* CSV files to search for series */
    size_t file_count, file_capacity;
    char **map_files;
    size_t map_file_count, map_file_capacity;
    double speed; /* replay speed as a factor; 0: not given */
    bool loop;
};

/* Adds an entry: `TAG=SERIES`, `TAG=SERIES*SCALE`, `TAG=SERIES*SCALE+OFFSET` (or -OFFSET). Errors go to diag. */
void sim_map_add(struct sim_map *map, const char *text, const char *file, int line, struct diag *diag);
void sim_map_add_file(struct sim_map *map, const char *path);
/* Reads a map file: lines with entries as in sim_map_add(), `values PATH` (CSV file with series, relative to the map file),
   `speed X` (replay speed), `loop` (replay without end), and # comments. */
void sim_map_read(struct sim_map *map, const char *path, struct diag *diag);
void sim_map_finish(struct sim_map *map);

#endif
