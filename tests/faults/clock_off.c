/* SPDX-License-Identifier: GPL-3.0-or-later */
/* LD_PRELOAD library: the program's wall clock is CLOCK_OFF_S seconds ahead of the machine's (negative: behind); its other
   clocks stay right. With CLOCK_OFF_FILE, that file gives the offset in seconds as an int64_t, and the clock follows each write
   to it. */
#include <fcntl.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#define EXPORTED __attribute__((visibility("default")))

static const volatile int64_t *in_file; /* offset in a shared file; NULL: CLOCK_OFF_S applies */

__attribute__((constructor)) static void map_file(void)
{
    const char *path = getenv("CLOCK_OFF_FILE");
    int file = path ? open(path, O_RDONLY | O_CLOEXEC) : -1;
    if (file < 0)
        return;
    void *bytes = mmap(NULL, sizeof *in_file, PROT_READ, MAP_SHARED, file, 0);
    in_file = bytes == MAP_FAILED ? NULL : bytes;
    close(file);
}

static time_t off_s(void)
{
    const char *text = getenv("CLOCK_OFF_S");
    return in_file ? (time_t)*in_file : text ? (time_t)atoll(text) : 0;
}

EXPORTED int clock_gettime(clockid_t id, struct timespec *now)
{
    int result = (int)syscall(SYS_clock_gettime, id, now);
    if (result == 0 && (id == CLOCK_REALTIME || id == CLOCK_REALTIME_COARSE))
        now->tv_sec += off_s();
    return result;
}

EXPORTED int gettimeofday(struct timeval *restrict now, void *restrict zone)
{
    int result = (int)syscall(SYS_gettimeofday, now, zone);
    if (result == 0)
        now->tv_sec += off_s();
    return result;
}

EXPORTED time_t time(time_t *at)
{
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    if (at)
        *at = now.tv_sec;
    return now.tv_sec;
}
