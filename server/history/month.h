/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The historian keeps one file for each month of UTC: history-2026-11.sqlite. */
#ifndef HISTORY_MONTH_H
#define HISTORY_MONTH_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define US_PER_S 1000000LL

/* Months since January 1970; negative before. */
int month_of(int64_t t_us);
int64_t month_begin_us(int month);
enum { MONTH_NAME_BYTES = 32 };
void month_name(int month, char name[MONTH_NAME_BYTES]);
bool month_parse(const char *name, int *month); /* false: not the name of such a file */
/* The months that a folder has files of, ascending. Free with mem_free. A folder that cannot be read has none. */
int *month_list(const char *folder, size_t *count);

#endif
