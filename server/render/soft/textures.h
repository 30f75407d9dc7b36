/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Materials and textures of the software renderer. Textures are sampled as in GL: bilinear within a mipmap level, linear between two
   levels. Immutable once made; any thread. Private to soft/. */
#ifndef RENDER_SOFT_TEXTURES_H
#define RENDER_SOFT_TEXTURES_H
#include "base/workers.h"
#include "render/gl/model.h"

enum { TEXTURE_LEVELS = 16 };

struct soft_texture {
    const uint8_t (*levels[TEXTURE_LEVELS])[4]; /* mipmap levels of the texture; the finest level points into the asset file */
    uint8_t (*coarse)[4];                       /* memory that holds all mipmap levels but the finest; owned by this struct */
    const float *linear; /* table that converts a texel's byte to 0..1: to linear light for sRGB textures, to byte / 255 for others */
    int width_px, height_px, level_count;
    bool repeat;
};

struct soft_material {
    const struct asset_material *of;
    const struct soft_texture *maps[MODEL_MAPS]; /* NULL: none */
    bool mapped;                                 /* true: the material has at least one texture map */
    bool blended;
    bool cut_out; /* true: the alpha of the base colour cuts holes into surfaces of this material */
};

struct soft_materials {
    struct soft_material *at;
    struct soft_texture *textures;
    size_t texture_count;
    float linear[256], plain[256];
};

/* Creates the materials of all models, one model after another, with mipmaps of their textures. The models must outlive the materials.
   Returns false when out of memory; call soft_materials_finish() in either case. */
bool soft_materials_init(struct soft_materials *materials, const struct gl_model *models, size_t model_count, struct workers *workers);
void soft_materials_finish(struct soft_materials *materials);

/* Weights of a triangle's corners at a point of the frame, and their change per pixel in x and y. */
struct soft_spread {
    float at[3], by_x[3], by_y[3];
};
/* weights: planes from soft_weights(). */
void soft_spread_at(const double weights[3][3], double x, double y, struct soft_spread *spread);
/* Computes texture coordinates at a point and their change per pixel in x and y: uv[0], uv[1], uv[2]. coordinates: by vertex of the file;
   NULL: all 0. */
void soft_spread_coordinates(const float (*coordinates)[2], const uint32_t vertices[3], const struct soft_spread *spread, float uv[3][2]);
/* Samples a texture. uv: from soft_spread_coordinates(). rgba: linear red, green, blue, and alpha, all 0..1. */
void soft_texture_color(const struct soft_texture *texture, float uv[3][2], float rgba[4]);
/* Returns the alpha (opacity) of a surface point: the product of the alphas of material, vertex colour and texture. */
float soft_alpha(const struct soft_material *material, const struct asset_view *file, const uint32_t vertices[3],
                 const struct soft_spread *spread);

#endif
