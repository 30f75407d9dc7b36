/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts between UTC months and the names of their history files. */
#include "history/month.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/mem.h"

int month_of(int64_t t_us)
{
    time_t seconds = (time_t)(t_us / US_PER_S - (t_us % US_PER_S < 0));
    struct tm tm;
    gmtime_r(&seconds, &tm);
    return (tm.tm_year - 70) * 12 + tm.tm_mon;
}

int64_t month_begin_us(int month)
{
    int year = 1970 + (month >= 0 ? month / 12 : -((11 - month) / 12));
    struct tm tm = { .tm_year = year - 1900, .tm_mon = month - (year - 1970) * 12, .tm_mday = 1 };
    return (int64_t)timegm(&tm) * US_PER_S;
}

void month_name(int month, char name[MONTH_NAME_BYTES])
{
    int64_t begin_us = month_begin_us(month);
    time_t seconds = (time_t)(begin_us / US_PER_S);
    struct tm tm;
    gmtime_r(&seconds, &tm);
    strftime(name, MONTH_NAME_BYTES, "history-%Y-%m.sqlite", &tm);
}

bool month_parse(const char *name, int *month)
{
    int year, of_year, length = 0;
    char again[MONTH_NAME_BYTES];
    if (sscanf(name, "history-%4d-%2d.sqlite%n", &year, &of_year, &length) != 2 || length == 0 || of_year < 1 || of_year > 12)
        return false;
    *month = (year - 1970) * 12 + of_year - 1;
    month_name(*month, again);
    return !strcmp(name, again);
}

static int ascending(const void *a, const void *b)
{
    return *(const int *)a - *(const int *)b;
}

int *month_list(const char *folder, size_t *count)
{
    int *months = NULL, month;
    size_t capacity = 0;
    DIR *dir = opendir(folder);
    *count = 0;
    for (struct dirent *entry; dir && (entry = readdir(dir));) {
        if (!month_parse(entry->d_name, &month))
            continue;
        mem_grow(&months, &capacity, *count + 1, sizeof(*months));
        months[(*count)++] = month;
    }
    if (dir)
        closedir(dir);
    if (*count)
        qsort(months, *count, sizeof(*months), ascending);
    return months;
}
