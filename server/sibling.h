/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs a program of this program's folder at a lower priority, in a cgroup of its own where that is possible (base/cgroup.h).
 * Thread: any, one at a time; it waits. */
#ifndef SIBLING_H
#define SIBLING_H
#include <stdbool.h>
#include <stddef.h>

enum { SIBLING_LENT = 3, SIBLING_PARTLY = 3 /* exit status of plantcast-import that imported some models */ };

struct sibling_params {
    const char *const *arguments;             /* ends in NULL; the first is the program's name */
    bool (*stop)(void *arg);                  /* asked several times a second: the program shall end */
    void (*say)(void *arg, const char *text); /* takes what it prints, piece by piece; NULL: it goes where ours goes */
    void *arg;                                /* of both */
    char **remark;                            /* receives its last line on stderr on SIBLING_PARTLY (mem_free); NULL: that is a failure */
    bool notifies;                            /* it may tell the service manager how far it is */
    int lent;                                 /* a descriptor that it has as SIBLING_LENT; 0: none */
    int timeout_s;                            /* after that it is told to end, and killed 30 s later; 0: unlimited */
    size_t memory_bytes;                      /* limit of each of its processes, and of all in its cgroup; 0: unlimited */
    const char *timeout_option, *memory_option; /* settings that raise these limits, for messages */
};

/* Returns NULL if it ended well; else one line, the last that it wrote to stderr or what ended it; mem_free. */
char *sibling_run(const struct sibling_params *params);

struct quotas;
/* Runs plantcast-prep with the limits of `quotas`. Of `how`, all but arguments and limits counts. Returns as sibling_run(). */
char *sibling_prepare(const struct sibling_params *how, const char *folder, const char *plant_path, const struct quotas *quotas);

#endif
