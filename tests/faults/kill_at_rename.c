/* SPDX-License-Identifier: GPL-3.0-or-later */
/* LD_PRELOAD library that kills the program, as kill -9 would, immediately before its n-th rename of a file. n: environment
   variable KILL_AT_RENAME, counted from 1. */
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <unistd.h>

__attribute__((visibility("default"))) int rename(const char *from, const char *to)
{
    static int count;
    const char *at = getenv("KILL_AT_RENAME");
    if (at && ++count == atoi(at))
        kill(getpid(), SIGKILL);
    return (int)syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0);
}
