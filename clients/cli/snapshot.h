/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What `plantcast snapshot` or `plantcast clip` was asked for. */
#ifndef CLI_SNAPSHOT_H
#define CLI_SNAPSHOT_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/text.h"
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
    double speed, fps;
    bool per_fragment, moving, no_overlay, offline_only; /* offline_only: something was asked for that a daemon does not offer */
};

/* Exit code, or -1: go on. */
int snapshot_parse(int argc, char **argv, bool clip, struct snapshot_options *options);
void snapshot_options_finish(struct snapshot_options *options);
/* `&name=value...`, encoded, as a daemon is asked. False: it cannot be; said why. */
bool snapshot_query(struct snapshot_options *options, struct text *query);
bool snapshot_add_arg(struct snapshot_options *options, const char *name, const char *value); /* false: too many */
int snapshot_offline(struct snapshot_options *options);                                       /* exit code */

#endif
