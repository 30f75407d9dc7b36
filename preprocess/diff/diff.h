/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares two revisions of a plant (`plantcast-prep --diff`): which assets changed, how far the surface moved under each
 * sensor, and which tags lost their position. Call from one thread only. */
#ifndef PREPROCESS_DIFF_H
#define PREPROCESS_DIFF_H
#include <stdatomic.h>

#include "preprocess/diff/diff_side.h"

/* DIFF_UNKNOWN: a file of the asset cannot be read */
enum diff_change { DIFF_SAME, DIFF_ADDED, DIFF_REMOVED, DIFF_MOVED, DIFF_CHANGED, DIFF_UNKNOWN, DIFF_CHANGES };
extern const char *const diff_changes[DIFF_CHANGES];

struct diff_asset {
    const char *id;
    enum diff_change change;
    /* why an asset counts as removed although the new plant file still lists its id, such as a missing node, or why its change is
     * unknown; NULL: there is no such reason */
    char *why;
    double move_m[3]; /* movement of the centre of the asset's bounding box, metres, in the plant frame */
    double moved_m;   /* largest movement of a corner of the asset's bounding box, metres */
    double turned_deg;
    double apart_m;      /* changed assets only: largest distance between the two surfaces after alignment, metres */
    double tolerance_m;  /* largest difference between the revisions, in metres, that does not count as a change */
    size_t triangles[2]; /* number of triangles in the old [0] and in the new [1] revision */
};

struct diff_sensor {         /* a tag that is a sensor in both revisions */
    const char *tag, *asset; /* name of the tag, and id of its asset in the new plant */
    const char *old_asset;   /* id of its asset in the old plant if that is another asset; NULL: the same asset */
    /* moved_m, place_moved_m, distance_m[0]: NaN if the sensor's place in the old revision is unknown */
    double moved_m;          /* distance between the surface points nearest to the sensor in the old and the new revision, metres */
    double place_moved_m;    /* movement of the position given by the tag list or the sensor's node, metres */
    double distance_m[2];    /* distance from the sensor's position to the surface in the old [0] and in the new [1] revision, metres */
    double limit_m;          /* distance of a sensor from the surface above which the report warns, metres */
    double tolerance_m;
    bool far_moved; /* true: the surface under the sensor moved by more than the tolerance */
};

struct diff_orphan {
    const char *tag, *asset;
    char *why;
};

struct diff {
    struct diag *diag; /* receives an error for each asset with an unreadable file; belongs to the caller */
    struct diff_side old_side, new_side;
    struct diff_asset *assets;
    struct diff_sensor *sensors;
    struct diff_orphan *orphans;
    const char **tags_added, **tags_removed;
    size_t asset_count, sensor_count, orphan_count, added_count, removed_count;
    size_t asset_room, sensor_room, orphan_room, added_room, removed_room;
};

/* Reads and compares both plants into *diff. tolerance_m: shapes and positions that differ by at most this count as equal; 0:
 * 10 mm, or 1 % of the asset's diagonal if that is less. Returns false if a plant cannot be read, with the reason in diag. Files
 * of single assets that cannot be read are errors in diag too, but the function then returns true. In either case, call diff_finish(). */
bool diff_run(struct diff *diff, const char *old_path, const char *new_path, double tolerance_m, struct diag *diag);
/* Frees the result of diff_run(). */
void diff_finish(struct diff *diff);

/* Prints the comparison of the two plants as text for users. */
void diff_text(const struct diff *diff, FILE *out);
/* Prints the comparison of the two plants as one JSON object. Returns false if out of memory. */
bool diff_json(const struct diff *diff, FILE *out);

#endif
