/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads memory usage from the kernel's files and from malloc. */
#include "base/system/memory.h"

#include <malloc.h>
#include <stdio.h>
#include <unistd.h>

#include "base/system/cgroup.h"

static const size_t MAX_DEFAULT_BYTES = (size_t)2 << 30;

size_t memory_machine_bytes(void)
{
    size_t machine = (size_t)sysconf(_SC_PHYS_PAGES) * (size_t)sysconf(_SC_PAGESIZE), group = cgroup_memory_bytes();
    return machine < group ? machine : group;
}

size_t memory_default_bytes(void)
{
    size_t quarter = memory_machine_bytes() / 4;
    return quarter < MAX_DEFAULT_BYTES ? quarter : MAX_DEFAULT_BYTES;
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
