/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs another program from this program's folder at a lower priority, in a cgroup of its own where possible
   (base/system/cgroup.h). Call from any thread, one at a time; blocks until the program ends. */
#ifndef HELPER_PROGRAM_H
#define HELPER_PROGRAM_H
#include <stdbool.h>
#include <stddef.h>

#include "base/log/log.h"

enum {
    HELPER_LENT = 3,
    HELPER_PARTLY = 3 /* HELPER_LENT: descriptor number under which the program inherits a lock; HELPER_PARTLY: exit status of
                                               plantcast-import if it imported only some models */
};

struct helper_params {
    const char *const *arguments; /* arguments, ending with NULL; the first is the program's name */
    bool (*stop)(void *arg);      /* callback, called several times a second; returns true if the program must end */
    /* callback that receives the program's output piece by piece; NULL: the output goes to this process's stdout and stderr */
    void (*say)(void *arg, const char *text);
    void *arg; /* argument of both callbacks */
    struct log *log;
    /* receives the program's last line on stderr if it exits with HELPER_PARTLY (mem_free); NULL: that exit status counts as a failure */
    char **remark;
    bool notifies;       /* true: the program may report its progress to the service manager */
    int lent;            /* open descriptor of this process, such as a lock, that the program inherits as HELPER_LENT; 0: none */
    int timeout_s;       /* seconds after which the program is told to end; 30 s later it is killed; 0: no limit */
    size_t memory_bytes; /* memory limit in bytes, for each process of the program and for its whole cgroup; 0: no limit */
    /* names of the command-line options that raise limit and memory limit, for messages to the user: timeout_option: of the
       time limit; memory_option: of the memory limit */
    const char *timeout_option, *memory_option;
};

/* Runs the program. Returns NULL on success; otherwise one line (mem_free): the program's last line on stderr, or the reason
   why the program was stopped. */
char *helper_run(const struct helper_params *params);

struct quotas;
/* Runs plantcast-prep with the limits of `quotas`. how: parameters for helper_run(), except arguments and limits. Returns as
   helper_run() does. */
char *helper_prepare(const struct helper_params *how, const char *folder, const char *plant_path, const struct quotas *quotas);

#endif
