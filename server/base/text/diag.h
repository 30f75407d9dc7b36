/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Collects diagnostics about files written by people: errors and warnings with file, line and column. Call from one thread only. */
#ifndef BASE_TEXT_DIAG_H
#define BASE_TEXT_DIAG_H
#include <stdio.h>

enum diag_severity { DIAG_ERROR, DIAG_WARNING };

struct diag_item {
    enum diag_severity severity;
    char *file;
    int line, column; /* position of the finding in the file, from 1; 0: no position */
    char *text;
    const char *form; /* format string of the text; diagnostics with the same format string are merged when printed */
};

struct diag { /* zero-initialise */
    struct diag_item *items;
    size_t count, capacity;
    int errors, warnings;
};

/* Adds a diagnostic; the text is formatted from `form` and copied. */
void diag_add(struct diag *diag, enum diag_severity severity, const char *file, int line, int column, const char *fmt, ...)
    __attribute__((format(printf, 6, 7)));
/* Adds a copy of a diagnostic from another list. */
void diag_copy(struct diag *diag, const struct diag_item *item);
#define diag_error(diag, file, line, column, ...) diag_add(diag, DIAG_ERROR, file, line, column, __VA_ARGS__)
#define diag_warning(diag, file, line, column, ...) diag_add(diag, DIAG_WARNING, file, line, column, __VA_ARGS__)
/* Prints all diagnostics as `file:line:column: error: text`, ordered by file and position. Many similar warnings in one file
   are merged into one line with their positions; of many similar errors only the first are printed. */
void diag_print(const struct diag *diag, FILE *out);
void diag_finish(struct diag *diag);

#endif
