/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Confines a process that reads untrusted files: Landlock restricts paths, TCP, signals and abstract sockets, seccomp restricts
   system calls. The restrictions apply to the process and to every process that it starts, and cannot be lifted. */
#ifndef BASE_SYSTEM_CONFINE_H
#define BASE_SYSTEM_CONFINE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/system/confine_calls.h"

enum confine_access {
    CONFINE_READ,
    CONFINE_EXECUTE, /* execute and read files */
    CONFINE_WRITE    /* the process may read and write, and create, rename and remove regular files and folders below the path */
};

struct confine_path {
    const char *path; /* path that the process may access: a file, or a folder including everything below; skipped if it does not exist */
    enum confine_access access;
};

struct confine_params {
    enum confine_role role;
    /* allowed paths, in addition to the system libraries, fonts and kernel files that every program needs */
    const struct confine_path *paths;
    size_t path_count;
    bool notifies; /* true: the process may send datagrams to the service manager's Unix socket */
    int most_abi;  /* newest Landlock ABI to use, for testing older kernels; 0: the kernel's */
};

/* Confines the calling thread and every process that it starts. Refused system calls return EPERM; system calls newer than this
   program's list return ENOSYS, so that libraries fall back to older ones. Drops capabilities, sets no_new_privs, and makes the
   kernel's OOM killer prefer this process. Skips restrictions that the kernel does not support (see confine_lacks()). Call it
   while the process has one thread, or between fork and exec: it allocates no memory. Returns 0 or -errno; after an error the
   process must exit. */
int confine(const struct confine_params *params);

enum { CONFINE_LACKS_BYTES = 400 };
/* Describes in one line which restrictions this kernel cannot enforce, and the first kernel version that can. Returns false if
   nothing is missing. */
bool confine_lacks(char out[CONFINE_LACKS_BYTES]);
/* Like confine_lacks(), for a kernel with the given Landlock ABI (0: none), and with or without seccomp. Pure. */
bool confine_lacks_with(int abi, bool calls, char out[CONFINE_LACKS_BYTES]);

/* Mirrors the kernel's struct landlock_ruleset_attr: the kinds of access that a ruleset restricts. */
struct confine_ruleset {
    uint64_t files, tcp, scoped;
};
/* Returns the flags of all kinds of access that a kernel with this Landlock ABI can restrict: it refuses a ruleset with newer
   flags. Pure. */
struct confine_ruleset confine_ruleset_of(int abi);

/* Makes this process's memory, descriptors and environment unreadable to other processes of its user, and disables core dumps. */
void confine_hide_memory(void);

/* Returns a copy of the environment reduced to search path, language, time zone, HOME, TMPDIR and, with `notifies`, the service
   manager's socket. `home`: new value of HOME and TMPDIR; NULL keeps both. The array and its strings are one block (mem_free). */
char **confine_environment(const char *home, bool notifies);

#endif
