/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The scalars of assets on the GPU, per asset and field parameters: uploaded when they differ by half a colour step or more from
   what is there. Least recently used ones go beyond a bound, but not those of the last picture. Thread: the one of the GL context. */
#ifndef RENDER_PLAN_FIELDS_H
#define RENDER_PLAN_FIELDS_H
#include "field/directions.h"
#include "field/field.h"
#include <glad/gl.h>

#include "gpu/gl.h"
#include "gpu/pool.h"

struct fields_entry { /* without a slice: it could not be worked out or kept; drawn as no data */
    int asset;
    struct field_params params;
    double step;            /* a value step that can be seen (scale_step) */
    uint64_t flags_version; /* of the scalars that are shown */
    double travel;          /* of the scalars, less how far what is shown is known to be off: scalars->travel - travel bounds the error */
    uint64_t content;       /* hash of the first `hashed` that are shown, as the last one who asked needs them */
    size_t hashed;
    struct scalar *shown;
    size_t count, ready; /* vertices: of the file; of which so many of the first are shown */
    struct pool_slice *slice;
    bool uploaded;  /* the slice holds what is shown */
    GLuint sensors; /* 0, or for fragments that work the field out themselves (render/reference/reference.h) */
    int64_t oldest_age_ns;
    double drawn_error; /* of the scalars (field/scalars.h) */
    uint64_t used;
    struct sensor_direction *directions; /* of a group that has some, else NULL (field/directions.h) */
    size_t direction_count;
    uint64_t directions_content;  /* hash of them */
    const struct scalars *behind; /* not NULL: to be shown next */
    size_t wanted;                /* of which so many are hashed */
};

struct fields {
    struct log *log;
    const struct reference *reference; /* NULL: not used */
    struct field *field;
    struct pool *pool;
    struct fields_entry **entries;
    struct fields_entry lost; /* stands for all that there is no room for */
    size_t count, capacity, bytes, bound_bytes;
    uint64_t uses, trimmed; /* trimmed: uses when that was done last */
};

void fields_init(struct fields *fields, struct log *log, struct field *field);
void fields_finish(struct fields *fields);
struct fields_ask {
    const int *assets;    /* none twice */
    const size_t *counts; /* by place in assets: so many of the first vertices at least */
    size_t asset_count;
    const struct field_params *params;
    double step;
    const struct snapshot *snapshot;
};
/* Into entries, by asset. NULL: that asset has nothing to show. Where there is no room (logged) that is shown as no data. Valid until the
   next fields_trim. */
void fields_get(struct fields *fields, const struct fields_ask *ask, const struct fields_entry **entries);
/* Brings what these show to the GPU, before it draws with them. Returns false where there was no room for one (logged): its entry is now
   one that is shown as no data. */
bool fields_upload(struct fields *fields, const int *assets, size_t count, const struct fields_entry **entries);
/* Between frames: drops what is beyond the bound. */
void fields_trim(struct fields *fields);
void fields_drop(struct fields *fields); /* drops all */

#endif
