/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Picks what is at a pixel: the asset, the position, and the value of the field there. Casts a ray; needs no GL.
   Thread: the one that owns the field. */
#ifndef RENDER_PICK_H
#define RENDER_PICK_H
#include "field/field.h"
#include "render/view.h"

enum pick_state {
    PICK_CONTEXT, /* nothing of the group is shown there: another asset, the inner side of a cut, or nothing at all */
    PICK_NO_DATA,
    PICK_BETWEEN,
    PICK_MEASURED /* a sensor that takes part stands there, and the field keeps readings */
};
enum { PICK_NEAREST = 4 };

struct pick {
    int asset; /* -1: nothing; then of all below only `sensor` and the times are set */
    double position_m[3], normal[3];
    enum pick_state state;
    bool uncertain, inside;
    double value; /* of PICK_BETWEEN and PICK_MEASURED; in the unit of the view. For operators the reading, not its place between limits */
    double drawn_error; /* in the same unit: pictures may be so far off around this place, and mark it uncertain; 0: they are not */
    int nearest_count;
    struct pick_sensor {
        int tag;
        double distance_m; /* in the chosen distance */
        double value;
        uint32_t quality;
    } nearest[PICK_NEAREST]; /* those that take part there, nearest first */
    int sensor;              /* the tag whose marker is at the pixel, or -1; one in sight if there is any */
    bool sensor_occluded;
    bool assumed; /* nobody knows where on the asset `nearest` is: its reading stands for all of it */
    int64_t data_utc_ns;
};

/* Picks at x_px, y_px, from the top left of the whole picture, also of a split view. Computes the field of `snapshot` at that point from
   the sensors' readings (field_at). */
void pick_at(const struct scene *scene, struct field *field, const struct view *view, const struct snapshot *snapshot, double x_px,
             double y_px, struct pick *out);

#endif
