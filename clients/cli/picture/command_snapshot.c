/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast snapshot`: requests a picture from a daemon, or draws it offline. */
#include <string.h>

#include "clients/cli/commands.h"
#include "saved_view.h"

static int from_daemon(struct snapshot_options *options)
{
    struct text path = { 0 }, query = { 0 };
    int code = 2;
    if (options->view && !saved_view_add_from_daemon(options, !options->at)) {
        code = 1;
        goto end;
    }
    if ((options->at && !snapshot_add_arg(options, "at", options->at)) || !snapshot_query(options, &query))
        goto end;
    const char *rest = query.at ? query.at : "";
    code = 0;
    if (options->pick) {
        text_add(&path, "/api/v1/pick?x=%.17g&y=%.17g%s", options->place_px[0], options->place_px[1], rest);
        code = daemon_download(options->access, options->from, path.at, NULL);
        path.length = 0;
    }
    text_add(&path, "/snapshot.png%s%s", *rest ? "?" : "", *rest ? rest + 1 : "");
    if (options->out && code == 0)
        code = daemon_download(options->access, options->from, path.at, options->out);
end:
    text_finish(&path);
    text_finish(&query);
    return code;
}

int cmd_snapshot(const struct daemon_access *access, int argc, char **argv)
{
    struct snapshot_options options;
    int code = snapshot_parse(argc, argv, false, &options);
    options.access = access;
    if (code < 0)
        code = strstr(options.from, "://") ? from_daemon(&options) : snapshot_offline(&options);
    snapshot_options_finish(&options);
    return code;
}
