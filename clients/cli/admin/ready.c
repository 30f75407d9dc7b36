/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast ready URL`: reports whether a daemon is ready, for health checks without curl. */
#include <stdio.h>
#include <string.h>

#include "clients/cli/commands.h"
#include "clients/cli/viewer/stream_reach.h"
#include "clients/link/daemon.h"

static const char usage[] =
    "usage: plantcast ready URL\n"
    "\n"
    "Checks that the daemon at URL (http://HOST:PORT/ or https://HOST:PORT/) serves pictures.\n"
    "Also checks that a WebSocket to the daemon can be opened, because a reverse proxy may block WebSockets.\n"
    "If the daemon is not ready, prints the reason. Exit status: 0 ready, 1 not ready.\n";

int cmd_ready(const struct daemon_access *access, int argc, char **argv)
{
    struct daemon_url url;
    struct text body = { 0 };
    bool help = argc == 2 && !strcmp(argv[1], "--help");
    if (argc != 2 || help) {
        fputs(usage, help ? stdout : stderr);
        return help ? 0 : 2;
    }
    if (!daemon_url_parse(argv[1], access, &url))
        return 2;
    int status = daemon_get(&url, "/readyz", &body);
    if (status && status != 200)
        fprintf(stderr, "plantcast: not ready: %s\n", body.at ? body.at : "");
    text_finish(&body);
    return status == 200 && stream_passes(&url) ? 0 : 1;
}
