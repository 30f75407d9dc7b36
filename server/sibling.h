/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs a program that lies beside this one, no more urgent than serving frames is. Thread: any; it waits. */
#ifndef SIBLING_H
#define SIBLING_H
#include <stdbool.h>

enum { SIBLING_LENT = 3, SIBLING_PARTLY = 3 /* exit status of plantcast-import that imported some models */ };

struct sibling_params {
    const char *const *arguments;             /* ends in NULL; the first is the program's name */
    bool (*stop)(void *arg);                  /* asked several times a second: the program shall end */
    void (*say)(void *arg, const char *text); /* takes what it prints, piece by piece; NULL: it goes where ours goes */
    void *arg;                                /* of both */
    char **remark;                            /* receives its last line on stderr on SIBLING_PARTLY (mem_free); NULL: that is a failure */
    bool notifies;                            /* it may tell the service manager how far it is */
    int lent;                                 /* a descriptor that it has as SIBLING_LENT; 0: none */
};

/* Returns NULL if it ended well; else one line, the last that it wrote to stderr or what ended it; mem_free. */
char *sibling_run(const struct sibling_params *params);

#endif
