/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast import --serve`: starts the daemon on a plant that engineers then build up on the web page. Call from one thread only. */
#ifndef PREPROCESS_IMPORT_SERVE_H
#define PREPROCESS_IMPORT_SERVE_H

struct serve_params {
    const char *folder; /* folder of the plant; created if missing */
    const char *port;
    char **files; /* models and a tag list to start with; imported as if an engineer had dropped them on the web page */
    int count;
};

/* Replaces this process with the daemon. Returns only on failure: the exit status, after printing one line on standard error. */
int import_serve(const struct serve_params *params);

#endif
