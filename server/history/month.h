/* SPDX-License-Identifier: GPL-3.0-or-later */
/* UTC months and the names of their history files, such as history-2026-11.sqlite. Call from any thread. */
#ifndef HISTORY_MONTH_H
#define HISTORY_MONTH_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define US_PER_S 1000000LL

/* Returns the number of months from January 1970 to the month of t_us (UTC); negative before 1970. */
int month_of(int64_t t_us);
int64_t month_begin_us(int month); /* Returns the start of a month, in microseconds UTC. */
enum { MONTH_NAME_BYTES = 32 };
void month_name(int month, char name[MONTH_NAME_BYTES]); /* Writes the name of a month's history file to `name`. */
bool month_parse(const char *name, int *month);          /* Parses a file name. Returns false if it is not the name of a month's file. */
/* Lists the months that have files in a folder, ascending; none if the folder cannot be read. Free with mem_free(). */
int *month_list(const char *folder, size_t *count);

#endif
