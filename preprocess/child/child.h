/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs a program, or a function of this program, on untrusted files: confined (confine.h), with limits of time and memory, in a process
 * group that is killed when the child ends. Thread: one call at a time per process, because it waits for signals. */
#ifndef PREPROCESS_CHILD_CHILD_H
#define PREPROCESS_CHILD_CHILD_H
#include <stdbool.h>
#include <stddef.h>

#include "base/system/confine.h"
#include "base/text/text.h"

enum { CHILD_WHY_BYTES = 400 };

struct child_params {
    const char *const *argv; /* terminated by NULL; argv[0] is a path, or a name to find in PATH */
    int (*call)(void *arg);  /* used instead of argv: a function run in a fork of this process; its result is the exit status */
    void *arg;               /* argument of `call` */
    const char *name;        /* subject of error messages: "the STEP reader" */
    const char *folder;      /* working directory of the child; also its TMPDIR and HOME */
    int timeout_s;
    size_t memory_bytes; /* limit of data memory, for the child and for each process it starts */
    /* options that messages name when a limit is exceeded, such as "--timeout"; memory_option may be NULL */
    const char *timeout_option, *memory_option;
    enum confine_role role;
    const struct confine_path *paths; /* files and folders that the child may use; the working directory only if it is listed */
    size_t path_count;
    int result; /* a descriptor that stays open besides stdin (/dev/null), stdout and stderr; 0: none */
    /* receives the child's stderr, at most 8 MB; `why` then stays empty if the child exited without a signal; NULL: not wanted */
    struct text *errors;
};

/* Runs the child to its end and appends its standard output, at most 8 MB, to out. Returns whether it exited with status 0. Otherwise `why`
 * holds one line: the limit or signal that ended the child, or its last line on stderr. SIGINT and SIGTERM end the child and are then
 * consumed. */
bool child_run(const struct child_params *params, struct text *out, char why[CHILD_WHY_BYTES]);

#endif
