/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One asset file on the GPU: geometry, materials, textures, and submeshes in drawing order. All instances of the asset share
   it. Call only in the thread that owns the GL context. */
#ifndef RENDER_GL_MODEL_H
#define RENDER_GL_MODEL_H
#include "gpu/gl.h"
#include "gpu/mesh.h"
#include "scene/asset.h"

enum model_map { MODEL_BASE_COLOR, MODEL_METALLIC_ROUGHNESS, MODEL_NORMAL, MODEL_OCCLUSION, MODEL_EMISSIVE, MODEL_MAPS };
/* colour ramps of a material (tables of colours from dark to bright). MUTED: greyed, for assets without a field; OWN: the material's own
   colours */
enum { MODEL_MUTED, MODEL_OWN, MODEL_RAMPS };
enum { MODEL_LIGHT_STEPS = 64 }; /* number of texels (brightness steps) in a material's colour ramp */

struct model_submesh { /* all triangles of one material in one level of detail */
    uint32_t material;
    bool blend, double_sided;
    GLsizei draws;
    GLsizei *counts; /* for glMultiDrawElements */
    const void **offsets;
    int triangles;
};

struct model_level {
    struct model_submesh *submeshes; /* opaque ones first */
    size_t submesh_count;
    float error_m;
    int triangles;
    uint32_t vertex_count;
    uint32_t first_primitive, primitive_count, first_cluster; /* indices in the asset file */
};

struct model_material {
    GLuint maps[MODEL_MAPS]; /* GL texture of each material map (enum model_map), owned by the model; 0: none */
    int mask;                /* bit mask, by enum model_map: texture maps that the material has */
    int second;              /* bit mask, by enum model_map: maps that use the second set of texture coordinates */
    bool masked;             /* true: alpha of the base colour cuts holes (glTF alphaMode MASK) */
};

struct gl_model {
    const struct asset *file;
    struct gpu_mesh mesh;
    struct model_level *levels;
    struct model_material *materials;
    GLuint *textures;
    size_t level_count, material_count, texture_count;
    GLuint material_buffer;
    /* colour ramps in main memory, by MODEL_MUTED and MODEL_OWN: MODEL_LIGHT_STEPS colours per material, from dark to bright */
    uint32_t *ramp_texels[MODEL_RAMPS];
    GLuint ramps[MODEL_RAMPS];          /* textures of the colour ramps, by MODEL_MUTED and MODEL_OWN; one row per material */
};

struct model_draws { /* working memory for the index ranges of one submesh's draws; zero-initialise */
    GLsizei *counts;
    const void **offsets;
    size_t count_capacity, offset_capacity;
};
void model_draws_finish(struct model_draws *draws);

/* Uploads the geometry of an asset file; materials_upload() uploads its materials and textures. Returns false when the GPU is out of
   memory; model_finish() must still be called. */
bool model_init(struct gl_model *model, struct gl *gl, const struct asset *file);
void model_finish(struct gl_model *model);
/* Returns the model's coarsest level of detail whose error is at most error_m metres. */
const struct model_level *model_level(const struct gl_model *model, double error_m);
/* Draws one submesh; the model's mesh must be bound. */
void model_draw_submesh(const struct model_submesh *submesh);
/* Draws only those triangles of a level of detail that belong to closed bodies (scene/closed_bodies.h). */
void model_draw_closed(struct model_draws *draws, const struct gl_model *model, const struct model_level *level);

#endif
