/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The system calls that a confined process may make, as a seccomp filter. */
#ifndef BASE_SYSTEM_CONFINE_CALLS_H
#define BASE_SYSTEM_CONFINE_CALLS_H
#include <stdbool.h>

enum confine_role {
    CONFINE_READER, /* process that parses untrusted files: has threads, but starts no processes and sends signals only to itself */
    /* command of the site (its own program): starts programs, and may create links and change modes in its writable folder */
    CONFINE_COMMAND
};

/* Installs the system call filter for the calling thread, which must have no_new_privs. notifies: also allow messages to the
   service manager. Returns 0 or -errno. */
int confine_calls(enum confine_role role, bool notifies);

#endif
