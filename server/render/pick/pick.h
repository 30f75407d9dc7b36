/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Picks what is at a pixel: the asset, the position, and the value of the field there. Casts a ray; needs no GL. Call only in
   the thread that owns the field. */
#ifndef RENDER_PICK_H
#define RENDER_PICK_H
#include "field/field.h"
#include "render/view.h"

enum pick_state {
    /* the picked pixel shows no value of the group, but an asset without a sensor of the group, the inner side of a cut, or background */
    PICK_CONTEXT,
    PICK_NO_DATA,
    PICK_BETWEEN,
    PICK_MEASURED /* the picked pixel is at a contributing sensor, whose reading the interpolation reproduces */
};
enum { PICK_NEAREST = 4 };

struct pick {
    int asset; /* asset at the pixel; -1: none; only `sensor`, `sensor_occluded` and `data_utc_ns` of the members below are set then */
    double position_m[3], normal[3];
    enum pick_state state;
    bool uncertain, inside;
    /* value of the field at the pixel, in the view's unit, for PICK_BETWEEN and PICK_MEASURED. In a view of values relative to alarm limits
       (SHOW_OPERATOR), it is still the reading's value */
    double value;
    /* error bound of `value` in its unit, if frames mark this point as uncertain; 0: the point is not marked */
    double drawn_error;
    int nearest_count;
    struct pick_sensor {
        int tag;
        double distance_m; /* distance to the sensor in metres, straight or geodesic as in the view */
        double value;
        uint32_t quality;
    } nearest[PICK_NEAREST]; /* sensors that contribute to the value at the pixel, nearest first */
    int sensor;              /* tag whose marker is at the pixel, a visible one if there is any; -1: none */
    bool sensor_occluded;
    bool assumed; /* true if the sensor's position on its asset is unknown, so that its reading is used for the whole asset */
    int64_t data_utc_ns;
};

/* Picks at x_px, y_px, in pixels from the top left of the whole frame, even in a split view. Computes the field of `snapshot`
   at that point from the sensors' readings (field_at). */
void pick_at(const struct scene *scene, struct field *field, const struct view *view, const struct snapshot *snapshot, double x_px,
             double y_px, struct pick *out);

#endif
