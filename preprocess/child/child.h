/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs a program, or a function of this one, on a stranger's file: confined (confine.h), with limits of time and memory, in a process
 * group of its own that ends with it. Thread: one at a time per process, since it waits for signals. */
#ifndef PREPROCESS_CHILD_CHILD_H
#define PREPROCESS_CHILD_CHILD_H
#include <stdbool.h>
#include <stddef.h>

#include "base/system/confine.h"
#include "base/text/text.h"

enum { CHILD_WHY_BYTES = 400 };

struct child_params {
    const char *const *argv;  /* ends in NULL; argv[0] is a path, or a name that is looked up in PATH */
    int (*call)(void *arg);   /* in place of argv: runs in a forked copy of this process, and returns its exit status */
    void *arg;                /* of call */
    const char *name;         /* subject of messages: "the STEP reader" */
    const char *folder;       /* where it runs; also its TMPDIR and HOME */
    int timeout_s;
    size_t memory_bytes;      /* of its data; each process that it starts has as much */
    const char *timeout_option, *memory_option; /* settings that raise the limits; memory_option may be NULL */
    enum confine_role role;
    const struct confine_path *paths; /* files and folders that it may use; the folder too only if it is among them */
    size_t path_count;
    int result;               /* a descriptor that it keeps, besides stdin (/dev/null), stdout and stderr; 0: none */
    struct text *errors;      /* receives all that it wrote to stderr, at most 8 MB; then `why` stays empty where it ended by itself */
};

/* Runs the program to its end and appends what it printed, at most 8 MB, to out. Returns whether it exited with status 0. Otherwise `why`
 * holds one line: the limit or signal that ended it, or the last line that it wrote to stderr. SIGINT and SIGTERM end it, and are then
 * taken as answered. */
bool child_run(const struct child_params *params, struct text *out, char why[CHILD_WHY_BYTES]);

#endif
