/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Command line of `plantcast verify`, of pictures and of films. */
#ifndef CLI_PICTURE_VERIFY_H
#define CLI_PICTURE_VERIFY_H
#include "redraw.h"

struct verify_options {
    const char *path, *key; /* what is verified, and the file of the public key */
    struct redraw_options redraw;
    bool tour; /* of a film: its view may change */
};

/* Parses the command line into *options. Returns -1 to go on, or an exit code. */
int verify_parse(int argc, char **argv, struct verify_options *options);

#endif
