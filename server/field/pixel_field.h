/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields based on straight-line distances: shepard and paper (field.h) depend on these distances alone, so renderers evaluate
   them at the surface point of each pixel. Such a field is exact on triangles of any size and on every level of detail. Call
   from any thread. */
#ifndef FIELD_PIXEL_FIELD_H
#define FIELD_PIXEL_FIELD_H
#include <stdbool.h>
#include <stdint.h>

#include "plant/exact.h"

/* quantity that a field shows: the interpolated value, the distance from a sensor, or PIXEL_BLIND: the height that a hot spot
   at the pixel needs for the nearest sensor to show it */
enum pixel_show { PIXEL_SUM, PIXEL_DISTANCE, PIXEL_BLIND };
enum { PIXEL_CONFIGURED = 1, PIXEL_USABLE = 2, PIXEL_UNCERTAIN = 4, PIXEL_NO_LIMITS = 8 };

struct pixel_sensor {
    float place_m[3]; /* position of the sensor in metres, in the coordinates of the asset file */
    float value;      /* the sensor's value that is multiplied by its weight and summed */
    float strength, decay;
    uint32_t state; /* PIXEL_* bits; if neither PIXEL_USABLE nor PIXEL_NO_LIMITS is set, the sensor is lost */
};

/* A field that renderers evaluate at each pixel. Zero it before filling it, because fields are compared and hashed byte by
   byte, including padding. */
struct pixel_field {
    int32_t count; /* number of configured sensors; 0: the field is interpolated between vertices instead */
    int32_t paper, fill;
    enum pixel_show show;
    float power, reach_m, radius_m;        /* metres; reach_m INFINITY: no limit */
    /* value = sum / weight * scale + offset, limited to low..high; `empty` where the weight is 0 (struct kernel_value) */
    float scale, offset, low, high, empty;
    float hot_spot_m, seen, most;          /* PIXEL_BLIND */
    struct pixel_sensor *sensors;          /* array of `count` sensors, owned by this struct; NULL if count is 0 */
};

struct pixel_value {
    float value;
    bool no_data, uncertain, no_limits;
};
/* Evaluates the field at a point in coordinates of the asset file. */
void pixel_field_at(const struct pixel_field *field, const float point_m[3], struct pixel_value *out);
/* Returns the largest change of any of the field's values since `before`; INFINITY if anything but readings changed. */
float pixel_field_change(const struct pixel_field *field, const struct pixel_field *before);
/* Replaces *to, which must be zeroed or already filled, with a copy of *from that has its own sensors. */
void pixel_field_copy(struct pixel_field *to, const struct pixel_field *from);
void pixel_field_finish(struct pixel_field *field); /* frees the array of sensors and sets all members of the field to zero */
uint64_t pixel_field_hash(const struct pixel_field *field);

#endif
