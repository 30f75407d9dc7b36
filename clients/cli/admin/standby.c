/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast standby`: marks a standby core (the daemon that takes over if the leading one fails) as under maintenance. It
   tells the leading core so through a file in that core's history folder. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "clients/cli/commands.h"
#include "corelink/lease_keeper.h"

static void print_usage(FILE *out)
{
    fputs("usage: plantcast standby maintenance|normal NAME|FOLDER\n"
          "\n"
          "Run this command on the machine of the core that leads. NAME: name of the service plantcastd@NAME.\n"
          "FOLDER: history folder of the core.\n"
          "\n"
          "  maintenance  begin maintenance: this core leads alone, even while PostgreSQL is down. If this core\n"
          "               stops, no other core takes over: no core leads until this core runs again. PostgreSQL must be\n"
          "               reachable when maintenance begins. During maintenance, /metrics shows plantcast_core_standby_maintenance 1\n"
          "  normal       end maintenance: a standby that follows the core may take over again\n",
          out);
}

static int fail(const char *path, int error)
{
    fprintf(stderr, "plantcast: standby: %s: %s\n", path, strerror(error));
    return 1;
}

int cmd_standby(int argc, char **argv)
{
    static const char text[] = "standby: maintenance\n";
    bool begins = argc == 3 && !strcmp(argv[1], "maintenance"), ends = argc == 3 && !strcmp(argv[1], "normal");
    if (argc == 2 && (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h"))) {
        print_usage(stdout);
        return 0;
    }
    if (!begins && !ends) {
        print_usage(stderr);
        return 2;
    }
    bool is_folder = strchr(argv[2], '/');
    char *folder = is_folder ? mem_strdup(argv[2]) : mem_printf("/var/lib/plantcast/%s/history", argv[2]);
    char *path = mem_printf("%s/" LEASE_MAINTENANCE_FILE, folder);
    int error = access(folder, W_OK) != 0 ? errno : begins ? -atomic_file_put(path, text, strlen(text)) : unlink(path) != 0 ? errno : 0;
    int code = error && !(ends && error == ENOENT && access(folder, W_OK) == 0) ? fail(error == ENOENT ? folder : path, error) : 0;
    if (!code)
        printf("standby mode `%s`: the core applies this mode within 1 s and logs the change\n", argv[1]);
    mem_free(path);
    mem_free(folder);
    return code;
}
