/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs another program on a stranger's file: with a limit of time and memory, without a network, in a process group of its own that ends
 * with it. Thread: one at a time per process, since it waits for signals. */
#ifndef PREPROCESS_CHILD_CHILD_H
#define PREPROCESS_CHILD_CHILD_H
#include <stdbool.h>
#include <stddef.h>

#include "base/text.h"

enum { CHILD_WHY_BYTES = 400 };

struct child_params {
    const char *const *argv; /* ends in NULL; argv[0] is a path, or a name that is looked up in PATH */
    const char *folder;      /* where it runs; also its TMPDIR and HOME */
    int timeout_s;
    size_t memory_bytes; /* of its data; each process that it starts has as much */
};

/* Runs the program to its end and appends what it printed, at most 1 MB, to out. Returns whether it exited with status 0; else `why` has
 * one line: the last that it wrote to stderr, or what ended it. SIGINT and SIGTERM end it, and are then taken as answered. */
bool child_run(const struct child_params *params, struct text *out, char why[CHILD_WHY_BYTES]);

#endif
