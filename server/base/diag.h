/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Findings in what a person wrote: every one is kept, with file, line and column. Thread: one. */
#ifndef BASE_DIAG_H
#define BASE_DIAG_H
#include <stdio.h>

enum diag_severity { DIAG_ERROR, DIAG_WARNING };

struct diag_item {
    enum diag_severity severity;
    char *file;
    int line, column; /* from 1; 0 = not at one place */
    char *text;
    const char *form; /* what it was made with: those of one form say the same of several things */
};

struct diag { /* zero-initialise */
    struct diag_item *items;
    size_t count, capacity;
    int errors, warnings;
};

void diag_add(struct diag *diag, enum diag_severity severity, const char *file, int line, int column, const char *fmt, ...)
    __attribute__((format(printf, 6, 7)));
#define diag_error(diag, file, line, column, ...) diag_add(diag, DIAG_ERROR, file, line, column, __VA_ARGS__)
#define diag_warning(diag, file, line, column, ...) diag_add(diag, DIAG_WARNING, file, line, column, __VA_ARGS__)
/* `file:line:column: error: text`, in order of file, then place. Many warnings of one form in one file are one line, which says where. */
void diag_print(const struct diag *diag, FILE *out);
void diag_finish(struct diag *diag);

#endif
