/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The command lines of `plantcast snapshot` and `plantcast clip`. */
#ifndef CLI_PICTURE_SNAPSHOT_H
#define CLI_PICTURE_SNAPSHOT_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/text/text.h"
#include "gpu/gl.h"

struct plant;
struct daemon_access; /* clients/link/daemon.h */

enum { SNAPSHOT_MAX = 64 };
struct snapshot_options {
    const struct daemon_access *access; /* for requests to a daemon */
    /* from: plant file, or daemon's URL; out: file to write the picture to, NULL if only the value at a pixel is requested
       (`pick`) */
    const char *from, *out;
    char *args[SNAPSHOT_MAX]; /* parameters of the view as NAME=VALUE, as in the query of /snapshot.png; owned by the struct */
    size_t arg_count;
    const char *values[SNAPSHOT_MAX]; /* CSV files */
    size_t value_count;
    const char *view; /* id or title of the named view to show (saved_view.h); NULL: none */
    bool pick; /* true: also prints which equipment is at the pixel place_px, and the measured value that the pixel's colour shows */
    double place_px[2];
    /* CSV file of a baseline (readings with which the shown ones are compared) or, with a daemon, name of a saved baseline;
       NULL: none */
    const char *baseline;
    const char *prepared; /* folder of the files that plantcast-prep made for the plant; NULL: next to the plant file */
    enum gl_kind gl;
    struct gl_device gl_device;
    bool has_gl_device;
    const char *at;                  /* instant that the picture shows, as written on the command line; NULL: now */
    int64_t at_us;                   /* `at` in microseconds since 1970 */
    const char *history;             /* history folder; NULL: the one in the plant file */
    const char *from_text, *to_text; /* first and last instant of a clip, as on the command line; from_us, to_us: in microseconds since
                                        1970 */
    int64_t from_us, to_us;
    const char *tour; /* id of the tour (a sequence of views) that a clip shows; NULL: the clip shows a single view */
    double speed, fps;
    bool is_signed;                                      /* true: the clip contains the server's signature of each picture */
    bool per_fragment, moving, no_overlay, offline_only; /* offline_only: true: an option was given that only the offline renderer
                                                            supports */
};

/* Parses the command line into *options. Returns -1 to continue, or an exit code. Call snapshot_options_finish() in both cases. */
int snapshot_parse(int argc, char **argv, bool clip, struct snapshot_options *options);
/* Frees the memory that *options owns. */
void snapshot_options_finish(struct snapshot_options *options);
/* Returns the history folder: the one on the command line, otherwise the plant's. The caller frees it. */
char *snapshot_options_folder(const struct snapshot_options *options, const struct plant *plant);
/* Appends the options as `&name=value...`, URL-encoded, to the query of a request to a daemon. Returns false, with the reason
   printed, if daemons do not support one of the options. */
bool snapshot_query(struct snapshot_options *options, struct text *query);
/* Adds an argument NAME=VALUE to options->args. Returns false if there are too many. */
bool snapshot_add_arg(struct snapshot_options *options, const char *name, const char *value);
/* Draws the picture without a daemon. Returns the exit code. */
int snapshot_offline(struct snapshot_options *options);

#endif
