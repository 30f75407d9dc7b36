/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cgroups for child processes, if systemd delegates this service's cgroup to it (Delegate=memory pids; cgroup v2). The daemon
   moves into the cgroup "daemon" below the service's, because a cgroup that contains processes cannot limit its children. */
#ifndef BASE_CGROUP_H
#define BASE_CGROUP_H
#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

/* Moves this process into the cgroup "daemon" and enables memory and task limits for sibling cgroups of child processes. Call
   it once, before other threads start children. Returns false if systemd has not delegated the cgroup, or if the cgroup lacks
   these controllers. */
bool cgroup_divide(void);
/* Creates a cgroup NAME next to the daemon's, limited to memory_bytes (0: unlimited) and max_tasks. *path receives its folder
   for cgroup_destroy(), or NULL if cgroup_divide() did not succeed. Returns false with errno, and *path NULL, if the kernel
   refuses the cgroup. */
bool cgroup_create(const char *name, size_t memory_bytes, int max_tasks, char **path);
/* Moves a process into a cgroup. path NULL: no-op, returns true. Returns false with errno if the kernel refuses the move. */
bool cgroup_add(const char *path, pid_t pid);
/* Kills all processes of the cgroup, removes it and frees its path. Accepts a pointer to NULL. */
void cgroup_destroy(char **path);

/* Returns the smallest memory.max of this process's cgroup and its ancestors; SIZE_MAX: unlimited. */
size_t cgroup_memory_bytes(void);

#endif
