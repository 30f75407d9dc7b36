/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs subcommands in helper programs, which are in the same folder as this program. */
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "clients/link/daemon.h"
#include "commands.h"

/* Without /proc, this program cannot find its own folder; execvp() then searches PATH for the helper. */
void run_beside(const char *ending, const char *package, char **argv)
{
    char path[PATH_MAX] = "plantcast";
    ssize_t length = readlink("/proc/self/exe", path, sizeof(path) - strlen(ending) - 1);
    size_t end = length > 0 ? (size_t)length : strlen("plantcast");
    memcpy(path + end, ending, strlen(ending) + 1);
    execvp(path, argv);
    fprintf(stderr, "plantcast: %s: %s%s%s\n", path, strerror(errno), errno == ENOENT ? ": install the package " : "",
            errno == ENOENT ? package : "");
}

void run_film(const struct daemon_access *access, int argc, char **argv)
{
#ifdef PLANTCAST_H264
    char **line = access ? daemon_command_line(access, argc, argv) : NULL;
    run_beside("-film", "plantcast-h264", line ? line : argv);
    mem_free(line);
#else
    (void)access, (void)argc;
    fprintf(stderr, "plantcast: %s: clips need H.264, but this program was built without H.264 (CODECS=jpeg)\n", argv[0]);
#endif
}
