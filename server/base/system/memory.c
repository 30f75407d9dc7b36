/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From the kernel's files and from malloc. */
#include "base/system/memory.h"

#include <malloc.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const size_t MOST_BYTES = (size_t)2 << 30;

/* The first number in a file. False: there is none. */
static bool read_number(const char *path, unsigned long long *out)
{
    FILE *file = fopen(path, "re");
    bool good = file && fscanf(file, "%llu", out) == 1;
    if (file)
        fclose(file);
    return good;
}

/* Version 2 only: "0::/path". SIZE_MAX: no limit. */
static size_t control_group_bytes(void)
{
    char line[512], path[600];
    unsigned long long limit;
    FILE *file = fopen("/proc/self/cgroup", "re");
    bool found = false;
    while (file && !found && fgets(line, sizeof(line), file))
        found = strncmp(line, "0::", 3) == 0;
    if (file)
        fclose(file);
    if (!found)
        return SIZE_MAX;
    line[strcspn(line, "\n")] = 0;
    snprintf(path, sizeof(path), "/sys/fs/cgroup%s/memory.max", line + 3);
    return read_number(path, &limit) ? (size_t)limit : SIZE_MAX;
}

size_t memory_machine_bytes(void)
{
    size_t machine = (size_t)sysconf(_SC_PHYS_PAGES) * (size_t)sysconf(_SC_PAGESIZE), group = control_group_bytes();
    return machine < group ? machine : group;
}

size_t memory_default_bytes(void)
{
    size_t quarter = memory_machine_bytes() / 4;
    return quarter < MOST_BYTES ? quarter : MOST_BYTES;
}

void memory_measure(struct memory_use *use)
{
    unsigned long long all = 0, resident = 0, shared = 0;
    size_t page = (size_t)sysconf(_SC_PAGESIZE);
    FILE *file = fopen("/proc/self/statm", "re");
    *use = (struct memory_use){ 0 };
    if (file && fscanf(file, "%llu %llu %llu", &all, &resident, &shared) == 3 && resident >= shared) {
        use->resident = (size_t)resident * page;
        use->anonymous = (size_t)(resident - shared) * page;
    }
    if (file)
        fclose(file);
#ifdef __GLIBC__
    struct mallinfo2 info = mallinfo2();
    use->allocated = info.uordblks + info.hblkhd;
#endif
}

void memory_trim(void)
{
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}
