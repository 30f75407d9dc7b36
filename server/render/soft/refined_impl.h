/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of a refined frame (camera at rest, four samples per pixel) that is kept between its drawing steps. Private to soft/. */
#ifndef RENDER_SOFT_REFINED_IMPL_H
#define RENDER_SOFT_REFINED_IMPL_H
#include "render/soft/soft_impl.h"
#include "render/soft/lanes.h"
#include "render/light/environments.h"
#include "render/soft/tile.h"
#include "render/soft/tones.h"

enum { REFINED_ROWS = 16, SAMPLES = VISIBILITY_MOST_PARTS };
/* Sample positions relative to the pixel's centre: a rotated square. An edge of almost any slope passes the samples one at a
   time, which smooths it. */
extern const float refined_samples[SAMPLES][2];

/* Special ids of samples that show no triangle; other values are triangle ids (render/soft/tile.h). */
#define ID_NOTHING 0xffffffffu
#define ID_CAP 0xfffffffeu /* special id: the sample shows a section cap, the cut face of a closed body */

enum { NORMAL_X, NORMAL_Y, NORMAL_Z, AMBIENT, OPEN, TINT }; /* indices of vertex attributes in arrays that have eight elements per vertex */
enum { BASE, METALLIC = 3, ROUGHNESS, EMISSIVE }; /* indices of material attributes in arrays that have eight elements per material */

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
    size_t at; /* number of work items (samples, bands or rows) of the current step that are done */
    bool failed;
    float (*normals)[9]; /* by mesh: matrix that rotates normals from the asset file to the plant frame, column by column */
    size_t mesh_capacity;
    uint8_t *caps; /* section caps: one bit per sample of each pixel, rows of pitch_px. NULL: no section plane cuts the scene */
    struct visibility_buffer *buffer;
    /* --- members that are set again at each step of drawing the refined frame --- */
    const struct frame_context *context;
    struct environment_light surroundings;
    float sun_from_pixel[4][4], sun_from_ground[4][4]; /* matrices, as columns */
    /* Matrix, column by column, that maps a surface's normal to an offset in the sun's shadow map. The offset moves the
       looked-up point off its own surface; otherwise the surface would shade itself (shadow acne). */
    float sun_from_normal[3][3];
    /* offset in the sun's shadow map that is added to points of the ground, so that the ground does not shade itself (shadow
       acne) */
    float ground_step[3];
};

struct refined_item { /* one surface within a pixel */
    struct soft_triangle triangle;
    float x, y;     /* point of the frame, in pixels, where the surface's light is computed */
    uint16_t share; /* area of the pixel that the surface covers, 0..VISIBILITY_SHARES */
};

struct shaded_items { /* results of shading, by index of the refined_item (surface to shade); only for items that show the field */
    uint32_t *triangles, *weights;
    uint8_t *rows;
    struct visibility_gloss *gloss;
};

/* Finds the nearest opaque triangle at each sample of a band (group of pixel rows); rows are pitch_px elements apart. fragments: receives
   the blended triangles in front of the opaque ones. */
void refined_raster_band(const struct refined *refined, int band, const struct soft_sample samples[SAMPLES],
                         struct soft_fragments *fragments);
bool refined_shade_band(const struct refined *refined, int band); /* false: out of memory */
/* Adds the triangle of an item (a surface point to shade) to the band's list of triangles. Writes the triangle's index in that list,
   and the barycentric coordinates w1 and w2 of the item's point, to element `at` of `out`. */
void refined_keep_place(const struct refined *refined, struct visibility_band *band, const struct refined_item *item, float w1, float w2,
                        const struct shaded_items *out, size_t at);

#endif
