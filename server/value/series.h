/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads recorded series from CSV files; times count from the start of the file. Three forms are supported:
   wide: a header line, one column is the time, the others are series by their names. The time is in a column whose name ends in _ms, _s,
     _min or _h, or it is a date and time (timestamp.h) in a column called Time, Timestamp, UTC, DateTime or Date, or in the first one;
   values: a header line with Tag, Time and Value, perhaps Unit: one value a line, as `plantcast history export` prints it;
   long: no header, lines of `time in ms,type,entity,property,value,...`, series by `entity/property`.
   Dates and times without a zone are of the program's zone. Thread: one. */
#ifndef VALUE_SERIES_H
#define VALUE_SERIES_H
#include <stdbool.h>
#include <stddef.h>

struct series {
    char *name;
    char *unit;               /* as stated in its lines; NULL: not stated */
    double *time_s, *value;   /* times rise; 0 is the first line of the file. A value is NaN where the file says that there is none */
    size_t count, capacity, value_capacity;
    double length_s;          /* of the whole file, one step after its last line: when a loop starts again */
};

/* Reads the named series. Returns false if it cannot, with file and line in why; *found tells whether the series is there at all. Free with
   series_finish(). */
bool series_read(struct series *series, const char *path, const char *name, bool *found, char why[200]);
void series_finish(struct series *series);
/* Returns the last value recorded at or before time_s, or the first value if time_s is before it. loop: repeats after length_s. */
double series_at(const struct series *series, double time_s, bool loop);

struct series_names {
    char **at;
    size_t count, capacity;
    bool whole; /* all of the file was read */
};

/* Lists the series of a file, by reading its beginning. Returns false if it cannot, with the reason in why. */
bool series_list(struct series_names *names, const char *path, char why[200]);
void series_names_finish(struct series_names *names);

#endif
