/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cache of field values (scalars) on the GPU, per asset and field parameters. An entry is uploaded when its values differ from
   the GPU's copy by half a colour step or more. Beyond the size limit, the least recently used entries are evicted, except
   those of the last frame. Call only in the thread that owns the GL context. */
#ifndef RENDER_PLAN_FIELDS_H
#define RENDER_PLAN_FIELDS_H
#include "field/directions.h"
#include "field/field.h"
#include <glad/gl.h>

#include "gpu/gl.h"
#include "gpu/pool.h"

/* Field of one asset. An entry without a slice (range of a GPU buffer), for lack of memory or of values, is drawn as no data. */
struct fields_entry {
    int asset;
    struct field_params params;
    double step;            /* smallest difference of values that is visible in the colours (scale_step) */
    uint64_t flags_version; /* scalars->flags_version of the shown values */
    /* value of scalars->travel (sum of the largest changes of all versions) at the version that the shown values come from; if
       the shown values already deviated from that version, the deviation is subtracted. So scalars->travel - travel is an upper
       bound of the error of any shown value */
    double travel;
    uint64_t content; /* hash of the first `hashed` values in `shown`: the values that the last fields_get() requested */
    size_t hashed;    /* number of values in `shown` that the hash `content` covers; SIZE_MAX: `content` is out of date */
    /* sensors of a field that is evaluated at pixels; count 0: the field is interpolated between vertices, from `shown` */
    struct pixel_field pixels;
    struct scalar *shown;
    /* count: number of the asset file's vertices; ready: number of vertices, from the first on, whose values `shown` holds */
    size_t count, ready;
    struct pool_slice *slice;
    bool uploaded;  /* true: the values in `shown` are also in `slice`, a range of a GPU buffer */
    GLuint sensors; /* buffer of sensors for shaders that compute the field at each fragment (render/reference/reference.h); 0: none */
    struct sensor_cells *cells; /* lists of the sensors near each place (render/gl/sensor_cells.h); NULL: none */
    int64_t oldest_age_ns;
    double drawn_error; /* bound of the error of interpolating `shown` within triangles (struct scalars, field/scalars.h) */
    uint64_t used;
    struct sensor_direction *directions; /* directions of the group's sensors (field/directions.h); NULL: the group has none */
    size_t direction_count;
    uint64_t directions_content;  /* hash of the directions */
    const struct scalars *behind; /* newer values that must be copied into `shown`; NULL: `shown` is up to date */
    size_t wanted;                /* number of vertices to hash */
};

struct fields {
    struct log *log;
    const struct reference *reference; /* NULL: not used */
    struct field *field;
    struct pool *pool;
    struct fields_entry **entries;
    struct fields_entry lost; /* placeholder that shows no data, in place of the entries of fields that do not fit in memory */
    size_t count, capacity, bytes, bound_bytes;
    /* uses: number of fields_get() lookups so far; trimmed: value of `uses` at the last fields_trim(), after which looked-up entries are
       not evicted */
    uint64_t uses, trimmed;
};

void fields_init(struct fields *fields, struct log *log, struct field *field);
void fields_finish(struct fields *fields);
struct fields_ask {
    const int *assets;    /* indices, without duplicates */
    const size_t *counts; /* by index in `assets`: number of vertices, counted from the first in the file, whose values must be ready */
    size_t asset_count;
    const struct field_params *params;
    double step;
    const struct snapshot *snapshot;
};
/* Writes the entry of each requested asset into `entries` (indexed by asset). NULL: the asset shows no field. An asset whose
   entry does not fit in memory gets one that shows no data, and the failure is logged. The entries are valid until the next
   fields_trim(). */
void fields_get(struct fields *fields, const struct fields_ask *ask, const struct fields_entry **entries);
/* Returns how many of an asset's first `count` vertices need computed values for fields_get(): fewer if the field is evaluated at
   pixels. */
size_t fields_vertices(const struct fields *fields, int asset, const struct field_params *params, size_t count);
/* Uploads the entries of these assets; call before the GPU draws with them. Returns false if an entry did not fit, which is logged: its
   element of `entries` then points to an entry that shows no data. */
bool fields_upload(struct fields *fields, const int *assets, size_t count, const struct fields_entry **entries);
/* Evicts cache entries until the rest fits the memory limit. Call between frames. */
void fields_trim(struct fields *fields);
void fields_drop(struct fields *fields); /* evicts all entries */

#endif
