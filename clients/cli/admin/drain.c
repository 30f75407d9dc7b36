/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast drain`: makes a daemon on this machine close its sessions, so that they connect to other daemons. */
#include <errno.h>
#include <getopt.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "clients/cli/commands.h"

/* WAIT_S: seconds to wait for the daemon: 2 until load balancers send it no new sessions, 10 to close its sessions, 1 in
   reserve; LOOK_US: microseconds between checks whether the daemon has exited */
enum { WAIT_S = 13, LOOK_US = 50000 };

static void print_usage(FILE *out)
{
    fputs("usage: plantcast drain PID [--wait SECONDS]\n"
          "\n"
          "Sends SIGUSR1 to the daemon with process ID PID, which moves its sessions to other daemons within 12 s.\n"
          "Returns after the time given with --wait, or when the daemon has exited.\n"
          "Intended for the preStop hook of a container and for ExecStop= of a systemd unit.\n"
          "\n"
          "  --wait SECONDS  time to wait after the signal; 0: do not wait (default: 13, which is enough for all sessions to move)\n",
          out);
}

/* Returns true if the process's name is plantcastd. Checked before sending SIGUSR1, because that signal would end most other programs. */
static bool is_daemon(pid_t pid)
{
    char path[64], name[32] = "";
    snprintf(path, sizeof(path), "/proc/%d/comm", (int)pid);
    FILE *file = fopen(path, "r");
    if (!file)
        return false;
    size_t count = fread(name, 1, sizeof(name) - 1, file);
    fclose(file);
    name[count] = 0;
    return !strcmp(name, "plantcastd\n");
}

static int drain(pid_t pid, int wait_s)
{
    int64_t end_ns = clock_mono_ns() + wait_s * NS_PER_S;
    if (!is_daemon(pid)) {
        fprintf(stderr, "plantcast: no plantcastd has the process ID %d\n", (int)pid);
        return 1;
    }
    if (kill(pid, SIGUSR1) != 0) {
        fprintf(stderr, "plantcast: %d: %s\n", (int)pid, strerror(errno));
        return 1;
    }
    while (clock_mono_ns() < end_ns && kill(pid, 0) == 0)
        usleep(LOOK_US);
    return 0;
}

int cmd_drain(int argc, char **argv)
{
    static const struct option options[] = {
        { "wait", required_argument, NULL, 'w' },
        { "help", no_argument, NULL, 'h' },
        { NULL, 0, NULL, 0 },
    };
    int wait_s = WAIT_S;
    for (int option; (option = getopt_long(argc, argv, "", options, NULL)) != -1;)
        switch (option) {
        case 'w': wait_s = atoi(optarg); break;
        case 'h': print_usage(stdout); return 0;
        default: print_usage(stderr); return 2;
        }
    char *end = NULL;
    long pid = optind + 1 == argc ? strtol(argv[optind], &end, 10) : 0;
    if (!end || *end || pid < 1 || pid > INT_MAX || wait_s < 0 || wait_s > 3600) {
        print_usage(stderr);
        return 2;
    }
    return drain((pid_t)pid, wait_s);
}
