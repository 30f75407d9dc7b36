/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts picture options to the query of a request to a daemon. */
#include "snapshot.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

static void add_encoded(struct text *path, const char *arg)
{
    for (; *arg; arg++)
        text_add(path, isalnum((unsigned char)*arg) || strchr("-_.=,", *arg) ? "%c" : "%%%02X", (unsigned char)*arg);
}

/* Writes the query of a daemon's /snapshot.png, without the leading '?'. */
bool snapshot_query(struct snapshot_options *options, struct text *query)
{
    if (options->offline_only) {
        fputs("plantcast: --values, --history, --prepared, --tier, --no-overlay, --field and --gl need a plant file, not a URL\n", stderr);
        return false;
    }
    if (options->baseline && !snapshot_add_arg(options, "baseline", options->baseline))
        return false;
    for (size_t i = 0; i < options->arg_count; i++) {
        text_add(query, "&");
        add_encoded(query, options->args[i]);
    }
    return true;
}
