/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Saves a daemon's response to a file. */
#include <stdio.h>
#include <string.h>

#include "base/files/atomic_file.h"
#include "clients/cli/commands.h"
#include "clients/link/daemon.h"

int daemon_download(const struct daemon_access *access, const char *url_text, const char *path, const char *out)
{
    struct daemon_url url;
    struct text body = { 0 };
    if (!daemon_url_parse(url_text, access, &url))
        return 1;
    int status = daemon_get(&url, path, &body), result = 1;
    if (status == 200) {
        if (!out)
            printf("%s\n", body.at ? body.at : "");
        int error = !out ? 0 : atomic_file_put(out, body.at ? body.at : "", body.length);
        if (error)
            fprintf(stderr, "plantcast: %s: %s\n", out, strerror(-error));
        result = error ? 1 : 0;
    } else if (status) {
        fprintf(stderr, "plantcast: %s: the daemon answered with HTTP status %d: %s\n", url_text, status, body.at ? body.at : "");
    }
    text_finish(&body);
    return result;
}
