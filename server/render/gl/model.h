/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One asset file on the GPU: geometry, materials, textures, and the order in which to draw them. Shared by all its instances.
   Thread: the one of the GL context. */
#ifndef RENDER_GL_MODEL_H
#define RENDER_GL_MODEL_H
#include "gpu/gl.h"
#include "gpu/mesh.h"
#include "scene/asset.h"

enum model_map { MODEL_BASE_COLOR, MODEL_METALLIC_ROUGHNESS, MODEL_NORMAL, MODEL_OCCLUSION, MODEL_EMISSIVE, MODEL_MAPS };
enum { MODEL_LIGHT_STEPS = 64 }; /* of a ramp */

struct model_submesh { /* the triangles of one material in one level */
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
    uint32_t first_primitive, primitive_count, first_cluster; /* in the file */
};

struct model_material {
    GLuint maps[MODEL_MAPS]; /* 0: none; owned by the model's textures */
    int mask;                /* bit per map that is there */
    int second;              /* likewise: it lies where the second texture coordinates put it */
    bool masked;             /* the base colour's alpha cuts holes */
};

struct model {
    const struct asset *file;
    struct mesh mesh;
    struct model_level *levels;
    struct model_material *materials;
    GLuint *textures;
    size_t level_count, material_count, texture_count;
    GLuint material_buffer, ramps, own_ramps; /* ramps: a row per material, sRGB by light; muted and not */
};

struct model_draws { /* zero-initialise: memory for one submesh's draws */
    GLsizei *counts;
    const void **offsets;
    size_t count_capacity, offset_capacity;
};
void model_draws_finish(struct model_draws *draws);

/* ramp_program: compiled ramp.comp. False: logged; finish copes with what is half-made. */
bool model_init(struct model *model, struct gl *gl, const struct asset *file, GLuint ramp_program);
void model_finish(struct model *model);
/* The coarsest level that errs by at most that. */
const struct model_level *model_level(const struct model *model, double error_m);
void model_draw_submesh(const struct model_submesh *submesh);
/* Only closed bodies (scene/closed_bodies.h), all of them. */
void model_draw_closed(struct model_draws *draws, const struct model *model, const struct model_level *level);

#endif
