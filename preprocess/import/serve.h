/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast import --serve`: the daemon on a plant that engineers bring in on its page. Thread: one. */
#ifndef PREPROCESS_IMPORT_SERVE_H
#define PREPROCESS_IMPORT_SERVE_H

struct serve_params {
    const char *folder; /* the plant's; made if it is not there */
    const char *port;
    char **files; /* models and a tag list to begin with, as if they had been dropped on the page */
    int count;
};

/* Becomes the daemon. Returns the exit status if it cannot, with one line on standard error. */
int import_serve(const struct serve_params *params);

#endif
