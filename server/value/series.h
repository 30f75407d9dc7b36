/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads recorded series from CSV files; times count from the start of the file. Three forms are supported. Wide: a header line;
   one column is the time, the others are series named by their headers. The name of the time column ends in _ms, _s, _min or
   _h. Or the column has dates and times (timestamp.h), and is called Time, Timestamp, UTC, DateTime or Date, or is the first
   one. Values: a header line with Tag, Time and Value, perhaps Quality and Unit; one value a line, as printed by `plantcast
   history export`. Long: no header, lines of `time in ms,type,entity,property,value,...`; a series is called `entity/property`.
   Dates and times without a zone are in the local zone of the process. Call from one thread only. */
#ifndef VALUE_SERIES_H
#define VALUE_SERIES_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct series {
    char *name;
    char *unit; /* unit stated in the lines of the file; NULL: none */
    /* time_s: times in seconds, ascending, 0 at the first line of the file; value: NaN where the file marks a value as missing */
    double *time_s, *value;
    uint32_t *quality; /* OPC UA quality of each sample; Good, or Bad without a value, unless the lines of the file state another */
    size_t count, capacity, value_capacity, quality_capacity;
    /* duration of the whole file in seconds: its last time plus one interval; a looping series starts again after this time */
    double length_s;
};

/* Reads the series with this name. Returns false with file, line and reason in `why` on failure; *found then tells whether the file has the
 * series at all. Free with series_finish(). */
bool series_read(struct series *series, const char *path, const char *name, bool *found, char why[200]);
void series_finish(struct series *series);
/* Returns the last value recorded at or before time_s, or the first value if time_s is earlier. loop: the series repeats after length_s. */
double series_at(const struct series *series, double time_s, bool loop);

struct series_names {
    char **at;
    size_t count, capacity;
    bool whole; /* true: the file was read to its end, so the list of series is complete */
};

/* Lists the series of a file by reading its beginning. Returns false with the reason in `why` if the file cannot be read. */
bool series_list(struct series_names *names, const char *path, char why[200]);
void series_names_finish(struct series_names *names);

#endif
