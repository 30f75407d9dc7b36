/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Command line of `plantcast snapshot` and `plantcast clip`. */
#ifndef CLI_PICTURE_SNAPSHOT_H
#define CLI_PICTURE_SNAPSHOT_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/text/text.h"
#include "gpu/gl.h"

enum { SNAPSHOT_MAX = 64 };
struct snapshot_options {
    const char *from, *out;   /* plant file or URL; file to write, or NULL if only a pick is asked for */
    char *args[SNAPSHOT_MAX]; /* name=value, as in the query of /snapshot.png; owned */
    size_t arg_count;
    const char *values[SNAPSHOT_MAX]; /* CSV files */
    size_t value_count;
    bool pick;            /* what is at place_px is printed */
    double place_px[2];
    const char *baseline; /* CSV file; of a daemon: a name. NULL: none */
    const char *prepared; /* NULL: beside the plant file */
    enum gl_kind gl;
    struct gl_device gl_device;
    bool has_gl_device;
    const char *at;      /* as it was given; NULL: now */
    int64_t at_us;       /* that instant */
    const char *history; /* folder; NULL: as the plant file says */
    const char *from_text, *to_text; /* of a clip; and below */
    int64_t from_us, to_us;
    const char *tour; /* of a clip; NULL: one view */
    double speed, fps;
    bool is_signed; /* of a clip: the server's signatures are kept */
    bool per_fragment, moving, no_overlay, offline_only; /* offline_only: something was asked for that a daemon does not offer */
};

/* Parses the command line into *options. Returns -1 to go on, or an exit code. Finish the options in both cases. */
int snapshot_parse(int argc, char **argv, bool clip, struct snapshot_options *options);
/* Frees what the options own. */
void snapshot_options_finish(struct snapshot_options *options);
/* Appends `&name=value...`, URL-encoded, as a daemon is asked. Returns false if the options ask for what a daemon does not offer, with the
   reason printed. */
bool snapshot_query(struct snapshot_options *options, struct text *query);
/* Adds a name=value argument. Returns false if there are too many. */
bool snapshot_add_arg(struct snapshot_options *options, const char *name, const char *value);
/* Draws the picture without a daemon. Returns the exit code. */
int snapshot_offline(struct snapshot_options *options);

#endif
