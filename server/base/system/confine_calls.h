/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The system calls that a confined process may make, as a seccomp filter. */
#ifndef BASE_SYSTEM_CONFINE_CALLS_H
#define BASE_SYSTEM_CONFINE_CALLS_H
#include <stdbool.h>

enum confine_role {
    CONFINE_READER, /* parses untrusted files: has threads, but starts no process and signals only itself */
    CONFINE_COMMAND /* a command of the site: starts programs, makes links and changes modes in the folder that it may write */
};

/* Installs the filter for the calling thread; needs no_new_privs. Returns 0 or -errno. */
int confine_calls(enum confine_role role, bool notifies);

#endif
