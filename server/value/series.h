/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recorded series from CSV files, by time since the start of the file. Two forms are known:
   wide: a header line, one column whose name ends in _ms, _s, _min or _h is the time, the others are series by their names;
   long: no header, lines of `time in ms,type,entity,property,value,...`, series by `entity/property`. Thread: one. */
#ifndef VALUE_SERIES_H
#define VALUE_SERIES_H
#include <stdbool.h>
#include <stddef.h>

struct series {
    char *name;
    double *time_s, *value;   /* times rise; 0 is the first line of the file */
    size_t count, capacity, value_capacity;
    double length_s;          /* of the whole file, one step after its last line: when a loop starts again */
};

/* Reads the named series. False: why (200 bytes) says so: which file and line. *found tells "no such series here" from an error. */
bool series_read(struct series *series, const char *path, const char *name, bool *found, char why[200]);
void series_finish(struct series *series);
/* The last value recorded at or before time_s; the first one before that. loop: starts again at length_s. */
double series_at(const struct series *series, double time_s, bool loop);

#endif
