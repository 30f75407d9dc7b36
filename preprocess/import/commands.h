/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The commands of plantcast-import. Each takes the arguments that follow its name and returns the exit status of the process. */
#ifndef PREPROCESS_IMPORT_COMMANDS_H
#define PREPROCESS_IMPORT_COMMANDS_H
#include <stdio.h>

int command_import(int argc, char **argv);
int command_nodes(int argc, char **argv);

/* Prints why a file or folder stopped the import. Always returns 1, the exit status. */
static inline int import_fail(const char *path, const char *why)
{
    fprintf(stderr, "plantcast import: %s: %s\n", path, why);
    return 1;
}

#endif
