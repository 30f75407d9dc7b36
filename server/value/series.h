/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recorded series from CSV files, by time since the start of the file. Three forms are known:
   wide: a header line, one column is the time, the others are series by their names. The time is in a column whose name ends in _ms, _s,
     _min or _h, or it is a date and time (base/timestamp.h) in a column called Time, Timestamp, UTC, DateTime or Date, or in the first one;
   values: a header line with Tag, Time and Value, perhaps Unit: one value a line, as `plantcast history export` prints it;
   long: no header, lines of `time in ms,type,entity,property,value,...`, series by `entity/property`.
   Dates and times without a zone are of the program's zone. Thread: one. */
#ifndef VALUE_SERIES_H
#define VALUE_SERIES_H
#include <stdbool.h>
#include <stddef.h>

struct series {
    char *name;
    char *unit;             /* as its lines say; NULL: nothing does */
    double *time_s, *value; /* times rise; 0 is the first line of the file */
    size_t count, capacity, value_capacity;
    double length_s; /* of the whole file, one step after its last line: when a loop starts again */
};

/* Reads the named series. False: why (200 bytes) says so: which file and line. *found tells "no such series here" from an error. */
bool series_read(struct series *series, const char *path, const char *name, bool *found, char why[200]);
void series_finish(struct series *series);
/* The last value recorded at or before time_s; the first one before that. loop: starts again at length_s. */
double series_at(const struct series *series, double time_s, bool loop);

struct series_names {
    char **at;
    size_t count, capacity;
    bool whole; /* else the file is longer than what was read */
};

/* What the file has, by its head. False: why. */
bool series_list(struct series_names *names, const char *path, char why[200]);
void series_names_finish(struct series_names *names);

#endif
