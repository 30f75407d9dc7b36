/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the steps of a plate hand to each other. Private to plate*.c. */
#ifndef RENDER_PLATE_IMPL_H
#define RENDER_PLATE_IMPL_H
#include "render/draft/draft_impl.h"
#include "render/draft/draft_simd.h"
#include "render/light/environment.h"
#include "render/plate/plate.h"
#include "render/visibility_buffers.h"

enum { PLATE_ROWS = 8, SAMPLES = RECOLOR_SHARES, BRDF_PX = 48, TONES = 4096 };
/* From a pixel's middle: a square turned so that edges of any slant take all steps. */
extern const float plate_samples[SAMPLES][2];

/* Samples: number of the chunk and of the triangle in it. */
enum { ID_BITS = 12 };
#define ID_NOTHING 0xffffffffu
#define ID_CAP 0xfffffffeu    /* a body that is cut open */
#define MARK_BACK 0x80000000u /* | number of the draw; a triangle that looks away */

enum { NORMAL_X, NORMAL_Y, NORMAL_Z, AMBIENT, OPEN, TINT }; /* of a vertex, in `lanes`: eight numbers */
enum { BASE, METALLIC = 3, ROUGHNESS, EMISSIVE };           /* of a material, likewise */

struct plate_draw {
    lanes material;
    uint32_t mesh;
    bool field, cut; /* cut: triangles that look away show the inner side */
};

struct plate_light { /* what drafts do not have of it */
    uint64_t id;
    uint8_t *open; /* of the ground, rows from the top */
    int open_px;   /* of a side */
};

struct plate_surroundings {
    GLuint mirrored; /* of which slot it is */
    float irradiance[ENVIRONMENT_TERMS][4];
    float (*texels)[4]; /* by roughness, octahedral */
    float brdf[BRDF_PX * BRDF_PX][2];
};

struct plates {
    struct workers *workers;
    const struct gpu_scene *gpu_scene;
    const struct sky *sky;
    struct draft *draft; /* keeps the light */
    const struct environments *environments;
    bool *textured, *masked, *blended; /* by model */
    struct plate_surroundings surroundings;
    struct plate_light light;
    float tones[TONES + 1]; /* sRGB of linear light, 0..1 */
    struct plate *spare;
    struct visibility_buffers kept; /* struct recolor */
};

struct plate {
    struct plates *plates;
    struct draft *draft; /* vertices, triangles, depth */
    enum {
        PLATE_CAPS,
        PLATE_COLLECT,
        PLATE_PLACE,
        PLATE_SORT,
        PLATE_SHADE,
        PLATE_INK,
        PLATE_GHOSTS,
        PLATE_MARK,
        PLATE_RIM,
        PLATE_SETTLE,
        PLATE_COLOR,
        PLATE_DONE
    } step;
    size_t at; /* in the step */
    bool failed;
    float (*normals)[9]; /* per mesh, columns: plant from file */
    struct plate_draw *draws;
    lanes *attributes; /* per vertex */
    size_t mesh_capacity, draw_capacity, attribute_capacity;
    uint8_t *caps; /* per pixel, rows of pitch_px: a bit for each sample. NULL: nothing is cut */
    struct recolor *recolor;
    /* --- of the picture, worked out anew at each step */
    const struct frame_context *context;
    float sun_from_pixel[4][4], sun_from_ground[4][4]; /* columns */
    float sun_from_normal[3][3];                       /* columns; a step off the surface */
    float ground_step[3];                              /* likewise off the ground */
};

struct samples { /* of a band; rows of pitch_px */
    float *depth[SAMPLES];
    uint32_t *ids[SAMPLES];
};

struct item { /* a surface in a pixel */
    uint32_t id;
    float x, y;    /* in the picture, where it is shaded */
    uint8_t share; /* of SAMPLES */
};

struct shaded_items { /* per item of the field */
    uint32_t *triangles, *weights;
    uint8_t *rows;
};

DRAFT_INLINE const struct draft_triangle *plate_triangle(const struct draft *draft, uint32_t id)
{
    return &draft->chunks[id >> ID_BITS].triangles[id & ((1u << ID_BITS) - 1)];
}

bool plate_read_light(struct plates *plates, const struct light_set *set);
bool plate_read_surroundings(struct plates *plates, int number);
void plate_raster_band(const struct plate *plate, int band, const struct samples *samples);
bool plate_shade_band(const struct plate *plate, int band); /* false: out of memory */
void plate_ink_band(const struct plate *plate, int band);
/* Eight items or fewer at a time. */
void plate_shade_field(const struct plate *plate, struct recolor_band *band, const struct item *items, size_t count,
                       const struct shaded_items *out);
void plate_shade_surfaces(const struct plate *plate, const struct item *items, size_t count, uint32_t *colors);
void plate_shade_sky(const struct plate *plate, int row, const uint8_t *wanted, uint32_t *colors);

#endif
