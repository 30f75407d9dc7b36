/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Materials and their textures, sampled as GL does: bilinear, between two levels. Immutable once made; any thread. Private to soft/. */
#ifndef RENDER_SOFT_TEXTURES_H
#define RENDER_SOFT_TEXTURES_H
#include "base/workers.h"
#include "render/gl/model.h"

enum { TEXTURE_LEVELS = 16 };

struct soft_texture {
    const uint8_t (*levels[TEXTURE_LEVELS])[4]; /* the finest one is the file's */
    uint8_t (*coarse)[4];                       /* the others, its own */
    const float *linear;                        /* linear light by byte; or the byte, 0..1 */
    int width_px, height_px, level_count;
    bool repeat;
};

struct soft_material {
    const struct asset_material *of;
    const struct soft_texture *maps[MODEL_MAPS]; /* NULL: none */
    bool mapped;                                 /* it has one */
    bool blended;
    bool cut_out; /* its base colour's alpha cuts holes */
};

struct soft_materials {
    struct soft_material *at;
    struct soft_texture *textures;
    size_t texture_count;
    float linear[256], plain[256];
};

/* Makes the materials of all models, one after another, with the coarser levels of their textures; the models must outlive them. Returns
   false when out of memory; call soft_materials_finish() in both cases. */
bool soft_materials_init(struct soft_materials *materials, const struct gl_model *models, size_t model_count, struct workers *workers);
void soft_materials_finish(struct soft_materials *materials);

/* Weights of a triangle's corners at a place of the picture, and how they change from pixel to pixel there. */
struct soft_spread {
    float at[3], by_x[3], by_y[3];
};
/* weights: of soft_weights(). */
void soft_spread_at(const double weights[3][3], double x, double y, struct soft_spread *spread);
/* Coordinates of a texture there, and how they change along rows and columns. coordinates: by vertex of the file; NULL: all 0. */
void soft_spread_coordinates(const float (*coordinates)[2], const uint32_t vertices[3], const struct soft_spread *spread, float uv[3][2]);
/* Colour of a texture there, 0..1: in linear light, and alpha. */
void soft_texture_color(const struct soft_texture *texture, float uv[3][2], float rgba[4]);
/* Alpha of a surface there: of its material, its vertices and its texture. */
float soft_alpha(const struct soft_material *material, const struct asset_view *file, const uint32_t vertices[3],
                 const struct soft_spread *spread);

#endif
