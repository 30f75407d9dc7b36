/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads this process's metrics from /proc/self. */
#include "base/metrics/process_counters.h"

#include <dirent.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "base/clock.h"

/* Numbers of fields in /proc/self/stat, counted from 1 as in proc(5). */
enum { STAT_THREADS = 20, STAT_START = 22, STAT_VIRTUAL = 23, STAT_RESIDENT = 24, STAT_LAST = STAT_RESIDENT };

static bool read_stat(unsigned long long fields[STAT_LAST + 1])
{
    char line[1024] = "";
    FILE *file = fopen("/proc/self/stat", "re");
    bool good = file && fgets(line, sizeof(line), file);
    if (file)
        fclose(file);
    char *at = good ? strrchr(line, ')') : NULL; /* uses the last ')': the program name in front may contain any characters */
    if (!at)
        return false;
    at = strchr(at, ' ');
    for (int i = 3; i <= STAT_LAST && at; i++, at = strchr(at, ' ')) {
        at++;
        if (i > 3 && sscanf(at, "%llu", &fields[i]) != 1)
            fields[i] = 0; /* stores 0 if the field is no unsigned number: a negative one, such as a priority */
    }
    return at != NULL;
}

static int64_t boot_s(void)
{
    struct timespec since_boot, now;
    clock_gettime(CLOCK_BOOTTIME, &since_boot);
    clock_gettime(CLOCK_REALTIME, &now);
    return (int64_t)(now.tv_sec - since_boot.tv_sec);
}

static int64_t count_files(void)
{
    DIR *folder = opendir("/proc/self/fd");
    /* number of open descriptors; starts at -3 because "." and "..", and the descriptor of the folder itself, are counted too */
    int64_t count = -3;
    for (; folder && readdir(folder);)
        count++;
    if (folder)
        closedir(folder);
    return count < 0 ? 0 : count;
}

void process_counters_set(struct counters *counters)
{
    unsigned long long fields[STAT_LAST + 1] = { 0 };
    struct rlimit files = { 0 };
    counter_set(counters_add_seconds(counters, "process_cpu_seconds_total", "counter",
                                     "Processor time of all threads of this process in seconds."),
                clock_work_ns() / 1000);
    if (read_stat(fields)) {
        counter_set(counters_add(counters, "process_threads", "gauge", "Number of threads of this process."),
                    (int64_t)fields[STAT_THREADS]);
        counter *start_s =
            counters_add(counters, "process_start_time_seconds", "gauge", "Start time of the process, in seconds since 1970.");
        if (atomic_load(start_s) == 0) /* sets the start time only once, so that later changes of the clock do not move it */
            counter_set(start_s, boot_s() + (int64_t)(fields[STAT_START] / (unsigned long long)sysconf(_SC_CLK_TCK)));
        counter_set(counters_add(counters, "process_virtual_memory_bytes", "gauge", "Virtual memory of this process in bytes."),
                    (int64_t)fields[STAT_VIRTUAL]);
        counter_set(counters_add(counters, "process_resident_memory_bytes", "gauge",
                                 "Resident memory of this process in bytes, including mapped files."),
                    (int64_t)fields[STAT_RESIDENT] * sysconf(_SC_PAGESIZE));
    }
    counter_set(counters_add(counters, "process_open_fds", "gauge", "Number of files and sockets that this process has open."),
                count_files());
    if (getrlimit(RLIMIT_NOFILE, &files) == 0)
        counter_set(counters_add(counters, "process_max_fds", "gauge",
                                 "Maximum number of files and sockets that this process may have open."),
                    (int64_t)files.rlim_cur);
}
