/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the steps of a refined frame hand to each other. Private to soft/. */
#ifndef RENDER_SOFT_REFINED_IMPL_H
#define RENDER_SOFT_REFINED_IMPL_H
#include "render/soft/soft_impl.h"
#include "render/soft/lanes.h"
#include "render/light/environments.h"
#include "render/soft/tile.h"
#include "render/soft/tones.h"

enum { REFINED_ROWS = 16, SAMPLES = VISIBILITY_MOST_PARTS };
/* From a pixel's middle: a square turned so that edges of any slant take all steps. */
extern const float refined_samples[SAMPLES][2];

/* Of samples, besides those of triangles (render/soft/tile.h). */
#define ID_NOTHING 0xffffffffu
#define ID_CAP 0xfffffffeu /* a body that is cut open */

enum { NORMAL_X, NORMAL_Y, NORMAL_Z, AMBIENT, OPEN, TINT }; /* of a vertex, in `lanes`: eight numbers */
enum { BASE, METALLIC = 3, ROUGHNESS, EMISSIVE };           /* of a material, likewise */

struct refined {
    struct raster raster;
    enum {
        REFINED_CAPS,
        REFINED_FIND,
        REFINED_SHADE,
        REFINED_INK,
        REFINED_GHOSTS,
        REFINED_MARK,
        REFINED_RIM,
        REFINED_SETTLE,
        REFINED_COLOR,
        REFINED_DONE
    } step;
    size_t at; /* in the step */
    bool failed;
    float (*normals)[9]; /* per mesh, columns: plant from file */
    size_t mesh_capacity;
    uint8_t *caps; /* per pixel, rows of pitch_px: a bit for each sample. NULL: nothing is cut */
    struct visibility_buffer *buffer;
    /* --- of the picture, worked out anew at each step */
    const struct frame_context *context;
    struct environment_light surroundings;
    float sun_from_pixel[4][4], sun_from_ground[4][4]; /* columns */
    float sun_from_normal[3][3];                       /* columns; a step off the surface */
    float ground_step[3];                              /* likewise off the ground */
};

struct refined_item { /* a surface in a pixel */
    struct soft_triangle triangle;
    float x, y;     /* in the picture, where it is shaded */
    uint16_t share; /* of VISIBILITY_SHARES */
};

struct shaded_items { /* per item of the field */
    uint32_t *triangles, *weights;
    uint8_t *rows;
    struct visibility_gloss *gloss;
};

/* Which triangle is nearest at each sample of a band; rows of pitch_px. fragments: of what is blended before it. */
void refined_raster_band(const struct refined *refined, int band, const struct soft_sample samples[SAMPLES],
                         struct soft_fragments *fragments);
bool refined_shade_band(const struct refined *refined, int band); /* false: out of memory */
/* Keeps the number in the band of the item's triangle, and where on it the item is: at that place of `out`. */
void refined_keep_place(const struct refined *refined, struct visibility_band *band, const struct refined_item *item, float w1, float w2,
                        const struct shaded_items *out, size_t at);

#endif
