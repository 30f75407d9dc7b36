/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs a program, or a function of this program, on untrusted files: confined (confine.h), with time and memory limits, in its
 * own process group, which is killed when the child ends. One call at a time per process, because it
 * waits for signals. */
#ifndef PREPROCESS_CHILD_CHILD_H
#define PREPROCESS_CHILD_CHILD_H
#include <stdbool.h>
#include <stddef.h>

#include "base/system/confine.h"
#include "base/text/text.h"

enum { CHILD_WHY_BYTES = 400 };

struct child_params {
    /* command line, terminated by NULL; argv[0] is a path, or a program name that is looked up in $PATH */
    const char *const *argv;
    int (*call)(void *arg);  /* used instead of argv: a function that runs in a fork of this process; its result is the exit status */
    void *arg;               /* argument of `call` */
    const char *name;        /* name of the child in error messages, such as "the STEP reader" */
    const char *folder;      /* working directory of the child; also its TMPDIR and HOME */
    int timeout_s;
    size_t memory_bytes; /* limit of data memory in bytes, for the child and for each process it starts */
    /* options that raise the limits, such as "--timeout", for messages about an exceeded limit; memory_option may be NULL */
    const char *timeout_option, *memory_option;
    enum confine_role role;
    /* files and folders that the child may use; the working directory must be listed too if the child needs it */
    const struct confine_path *paths;
    size_t path_count;
    int result; /* file descriptor that stays open in the child, besides stdin (/dev/null), stdout and stderr; 0: none */
    /* receives the child's error output, at most 8 MB; `why` then stays empty if the child exits without a signal; NULL: error
     * output is not wanted */
    struct text *errors;
};

/* Runs the child until it ends and appends its standard output, at most 8 MB, to out. Returns whether it exited with status 0.
 * Otherwise `why` holds one line: the limit or signal that ended the child, or its last line on stderr. SIGINT and SIGTERM end
 * the child but do not affect this process. */
bool child_run(const struct child_params *params, struct text *out, char why[CHILD_WHY_BYTES]);

#endif
