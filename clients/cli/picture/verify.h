/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Command line of `plantcast verify`, for pictures and films. */
#ifndef CLI_PICTURE_VERIFY_H
#define CLI_PICTURE_VERIFY_H
#include "redraw.h"

struct verify_options {
    const char *path, *key; /* path: signed picture or film to verify; key: file of the server's public key */
    struct redraw_options redraw;
    bool tour; /* true: a film may show a tour, so its view may change between pictures */
};

/* Parses the command line into *options. Returns -1 to continue, or an exit code. */
int verify_parse(int argc, char **argv, struct verify_options *options);

#endif
