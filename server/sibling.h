/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs another program from this program's folder at a lower priority, in a cgroup of its own where possible (base/cgroup.h). Thread:
   any, one at a time; blocks until the program ends. */
#ifndef SIBLING_H
#define SIBLING_H
#include <stdbool.h>
#include <stddef.h>

enum { SIBLING_LENT = 3, SIBLING_PARTLY = 3 /* exit status of plantcast-import if it imported only some models */ };

struct sibling_params {
    const char *const *arguments;             /* arguments, ending with NULL; the first is the program's name */
    bool (*stop)(void *arg);                  /* called several times a second; true: the program must end */
    /* receives the program's output piece by piece; NULL: it goes to this process's own stdout and stderr */
    void (*say)(void *arg, const char *text);
    void *arg;                                /* argument of both callbacks */
    /* after exit status SIBLING_PARTLY: receives the program's last line on stderr (mem_free); NULL: that status counts as a failure */
    char **remark;
    bool notifies;                            /* the program may report its progress to the service manager */
    int lent;                                 /* descriptor that the program gets as SIBLING_LENT; 0: none */
    int timeout_s;                            /* seconds after which the program is told to end; it is killed 30 s later; 0: unlimited */
    size_t memory_bytes; /* memory limit in bytes of each of its processes, and of all in its cgroup together; 0: unlimited */
    const char *timeout_option, *memory_option; /* names of the settings that raise these limits, for messages */
};

/* Returns NULL on success; otherwise one line (mem_free): the last one that the program wrote to stderr, or what ended it. */
char *sibling_run(const struct sibling_params *params);

struct quotas;
/* Runs plantcast-prep with the limits of `quotas`. `how` gives everything but arguments and limits. Returns as sibling_run(). */
char *sibling_prepare(const struct sibling_params *how, const char *folder, const char *plant_path, const struct quotas *quotas);

#endif
