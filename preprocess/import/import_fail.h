/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The error message by which plantcast-import reports a failed file or folder. */
#ifndef PREPROCESS_IMPORT_IMPORT_FAIL_H
#define PREPROCESS_IMPORT_IMPORT_FAIL_H
#include <stdio.h>

/* Prints why the file or folder `path` stopped the import. Always returns 1, the exit status. */
static inline int import_fail(const char *path, const char *why)
{
    fprintf(stderr, "plantcast import: %s: %s\n", path, why);
    return 1;
}

#endif
