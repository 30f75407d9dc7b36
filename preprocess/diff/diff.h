/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares two revisions of a plant (`plantcast-prep --diff`): which assets changed, how far the surface moved under each sensor, and which
   tags lost their place. Thread: one. */
#ifndef PREPROCESS_DIFF_H
#define PREPROCESS_DIFF_H
#include <stdatomic.h>

#include "preprocess/diff/diff_side.h"

enum diff_change { DIFF_SAME, DIFF_ADDED, DIFF_REMOVED, DIFF_MOVED, DIFF_CHANGED, DIFF_CHANGES };
extern const char *const diff_changes[DIFF_CHANGES];

struct diff_asset {
    const char *id;
    enum diff_change change;
    char *why;        /* removed: why it is not there, where its id still is; else NULL */
    double move_m[3]; /* of the middle of its box, plant frame */
    double moved_m;   /* the farthest that any corner of its box moved */
    double turned_deg;
    double apart_m;      /* changed: how far the surfaces are apart at most, once laid over each other */
    double tolerance_m;  /* less than that is no change */
    size_t triangles[2]; /* old, new */
};

struct diff_sensor {         /* a tag that is a sensor in both */
    const char *tag, *asset; /* asset: in the new one */
    double moved_m;          /* from where the surface was, to where it is */
    double place_moved_m;    /* of what the tag list or the node says */
    double distance_m[2];    /* from its place to the surface: old, new */
    double limit_m;          /* of that */
    double tolerance_m;
    bool far_moved; /* beyond the tolerance */
};

struct diff_orphan {
    const char *tag, *asset;
    char *why;
};

struct diff {
    struct diff_side old_side, new_side;
    struct diff_asset *assets;
    struct diff_sensor *sensors;
    struct diff_orphan *orphans;
    const char **tags_added, **tags_removed;
    size_t asset_count, sensor_count, orphan_count, added_count, removed_count;
    size_t asset_room, sensor_room, orphan_room, added_room, removed_room;
};

/* Reads both plants and compares them into *diff. tolerance_m: changes below it count as none; 0 means 10 mm, or 1 % of the asset's
   diagonal if that is less. Returns false if a plant cannot be read; diag says why. Call diff_finish() in both cases. */
bool diff_run(struct diff *diff, const char *old_path, const char *new_path, double tolerance_m, struct diag *diag);
/* Frees what diff_run() filled in. */
void diff_finish(struct diff *diff);

/* Prints the comparison as text for a person. */
void diff_text(const struct diff *diff, FILE *out);
/* Prints the comparison as one JSON object. Returns false if out of memory. */
bool diff_json(const struct diff *diff, FILE *out);

#endif
