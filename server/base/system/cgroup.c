/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Divides the service's cgroup between the daemon and its children, with the kernel's cgroup v2 files
   (Documentation/admin-guide/cgroup-v2.rst). */
#include "base/system/cgroup.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include "base/mem.h"

enum { REMOVE_TRIES = 50, REMOVE_PAUSE_MS = 20 };
static const char daemon_name[] = "/daemon";

/* Finds the mount point of cgroup v2; cgroup v1 may be mounted as well. */
static bool find_mount(char out[PATH_MAX])
{
    char line[2 * PATH_MAX], kind[32];
    FILE *file = fopen("/proc/self/mounts", "re");
    bool found = false;
    while (file && !found && fgets(line, sizeof(line), file))
        found = sscanf(line, "%*s %4095s %31s", out, kind) == 2 && !strcmp(kind, "cgroup2");
    if (file)
        fclose(file);
    return found;
}

/* Finds the path of this process's cgroup. */
static bool find_own(char out[PATH_MAX])
{
    char line[PATH_MAX] = "", mount[PATH_MAX];
    FILE *file = fopen("/proc/self/cgroup", "re");
    bool found = false;
    while (file && !found && fgets(line, sizeof(line), file))
        found = !strncmp(line, "0::/", 4);
    if (file)
        fclose(file);
    line[strcspn(line, "\n")] = 0;
    return found && find_mount(mount) && snprintf(out, PATH_MAX, "%s%s", mount, line[4] ? line + 3 : "") < PATH_MAX;
}

static bool write_file(const char *folder, const char *name, const char *text)
{
    char path[PATH_MAX];
    int file = snprintf(path, sizeof(path), "%s/%s", folder, name) < PATH_MAX ? open(path, O_WRONLY | O_CLOEXEC) : -1;
    bool good = file >= 0 && write(file, text, strlen(text)) == (ssize_t)strlen(text);
    int error = errno;
    if (file >= 0)
        close(file);
    errno = error;
    return good;
}

/* Finds this process's cgroup path. */
static bool is_delegated(const char *folder)
{
    char value[8];
    return getxattr(folder, "user.delegate", value, sizeof(value)) == 1 && value[0] == '1';
}

/* Finds the service's cgroup: the parent of this process's cgroup once the process has moved to "daemon". */
static bool find_service(char out[PATH_MAX])
{
    const size_t tail = sizeof(daemon_name) - 1;
    if (!find_own(out) || strlen(out) < tail || strcmp(out + strlen(out) - tail, daemon_name) != 0)
        return false;
    out[strlen(out) - tail] = 0;
    return is_delegated(out);
}

bool cgroup_divide(void)
{
    char service[PATH_MAX], own[PATH_MAX];
    if (!find_service(service)) {
        if (!find_own(service) || !is_delegated(service) || snprintf(own, sizeof(own), "%s%s", service, daemon_name) >= PATH_MAX ||
            (mkdir(own, 0755) != 0 && errno != EEXIST) || !write_file(own, "cgroup.procs", "0"))
            return false;
    }
    return write_file(service, "cgroup.subtree_control", "+memory +pids");
}

bool cgroup_create(const char *name, size_t memory_bytes, int max_tasks, char **path)
{
    char service[PATH_MAX], number[32];
    *path = NULL;
    if (!find_service(service))
        return true;
    *path = mem_printf("%s/%s", service, name);
    snprintf(number, sizeof(number), "%d", max_tasks);
    bool good = (mkdir(*path, 0755) == 0 || errno == EEXIST) && write_file(*path, "pids.max", number);
    snprintf(number, sizeof(number), "%zu", memory_bytes);
    good = good && write_file(*path, "memory.max", memory_bytes ? number : "max");
    int error = errno;
    /* ignores a failure: memory.swap.max does not exist if the kernel does not account for swap */
    write_file(*path, "memory.swap.max", "0");
    if (!good)
        cgroup_destroy(path);
    errno = error;
    return good;
}

bool cgroup_add(const char *path, pid_t pid)
{
    char number[16];
    snprintf(number, sizeof(number), "%d", (int)pid);
    return !path || write_file(path, "cgroup.procs", number);
}

/* Removes the cgroup. Killed processes leave it only after they have ended, so this waits for some milliseconds. */
void cgroup_destroy(char **path)
{
    if (!*path)
        return;
    write_file(*path, "cgroup.kill", "1");
    for (int i = 0; i < REMOVE_TRIES && rmdir(*path) != 0 && errno == EBUSY; i++)
        poll(NULL, 0, REMOVE_PAUSE_MS);
    mem_free(*path);
    *path = NULL;
}

size_t cgroup_memory_bytes(void)
{
    char folder[PATH_MAX], mount[PATH_MAX];
    size_t least = SIZE_MAX;
    for (bool more = find_own(folder) && find_mount(mount); more;) {
        unsigned long long limit;
        char *path = mem_printf("%s/memory.max", folder), *slash = strrchr(folder, '/');
        FILE *file = fopen(path, "re");
        if (file && fscanf(file, "%llu", &limit) == 1 && limit < least)
            least = (size_t)limit;
        if (file)
            fclose(file);
        mem_free(path);
        more = slash && strlen(folder) > strlen(mount);
        if (more)
            *slash = 0;
    }
    return least;
}
