/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A connection to a PostgreSQL server with timeouts for all operations: statements, and COPY of binary rows. After a failure
   only postgres_link_why() and postgres_link_close() may be called. Call from one thread only. */
#ifndef HISTORY_POSTGRES_POSTGRES_LINK_H
#define HISTORY_POSTGRES_POSTGRES_LINK_H
#include <libpq-fe.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "plant/plant.h"

enum { POSTGRES_WHY_BYTES = 300 };

struct postgres_link;
/* Connects. When the program ends, stop_fd becomes readable: from then on no call waits longer than two seconds. Returns NULL
   with the reason in `why` on failure. */
struct postgres_link *postgres_link_open(const struct plant_postgres *postgres, int stop_fd, char why[POSTGRES_WHY_BYTES]);
/* Like postgres_link_open(), with an explicit timeout for connecting and for each answer. */
struct postgres_link *postgres_link_open_within(const struct plant_postgres *postgres, int stop_fd, int64_t patience_ns,
                                                char why[POSTGRES_WHY_BYTES]);
/* Sets how long each of the following calls may wait for an answer from the server. */
void postgres_link_set_patience(struct postgres_link *link, int64_t patience_ns);
void postgres_link_close(struct postgres_link **link); /* Closes the connection and sets *link to NULL; accepts a pointer to NULL. */
const char *postgres_link_why(const struct postgres_link *link); /* Returns the reason for the last failure as text. */

/* Runs SQL statements and ignores any result rows. Returns false on failure. */
bool postgres_link_run(struct postgres_link *link, const char *sql);
/* Runs SQL statements given as a printf() format. Returns false on failure. */
bool postgres_link_runf(struct postgres_link *link, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
/* Runs one SQL statement with text parameters. Returns its rows in binary format, to be freed with PQclear(); NULL on failure. */
PGresult *postgres_link_ask(struct postgres_link *link, const char *sql, int count, const char *const *parameters);

/* Begins COPY table FROM STDIN (FORMAT binary). Add rows column by column with the functions postgres_copy_...(), and end with
   postgres_copy_end(). */
bool postgres_copy_begin(struct postgres_link *link, const char *table);
void postgres_copy_row(struct postgres_link *link, int columns);
void postgres_copy_int32(struct postgres_link *link, int32_t value);
void postgres_copy_int64(struct postgres_link *link, int64_t value);
void postgres_copy_time(struct postgres_link *link, int64_t t_us);   /* adds a column with a time; t_us: microseconds UTC since 1970 */
void postgres_copy_double(struct postgres_link *link, double value); /* adds a column with a number; NaN is sent as NULL */
void postgres_copy_text(struct postgres_link *link, const char *text);
void postgres_copy_bool(struct postgres_link *link, bool value);
/* Ends the COPY that postgres_copy_begin() began, so that the server stores all its rows. Returns false on failure. */
bool postgres_copy_end(struct postgres_link *link);

/* The four functions below return one column of a result row in binary format. */
int32_t postgres_int32(const PGresult *result, int row, int column);
int64_t postgres_int64(const PGresult *result, int row, int column);
int64_t postgres_time(const PGresult *result, int row, int column);
double postgres_double(const PGresult *result, int row, int column); /* returns a number; NULL becomes NaN */

#endif
