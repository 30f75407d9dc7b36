/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a glTF model into plain C arrays in which every number was checked. tinygltf stays behind this header. Thread: any, one per
   model. */
#ifndef PREPROCESS_MODEL_GLTF_SHIM_H
#define PREPROCESS_MODEL_GLTF_SHIM_H
#include "preprocess/model/model_source.h"
#include "protocol/asset_format.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gltf_primitive { /* triangles of one material; model units, the mesh's own frame */
    uint32_t vertex_count, index_count;
    float (*positions)[3];
    float (*normals)[3];          /* NULL: the model has none */
    float (*texcoords)[2];        /* where its material's textures lie; NULL: none */
    float (*second_texcoords)[2]; /* likewise those that the material's `second` names */
    uint8_t (*colors)[4];         /* NULL: none */
    uint32_t *indices;            /* a list of triangles, whatever it was */
    int material;                 /* -1: none */
};

struct gltf_mesh {
    char *name;
    uint32_t first_primitive, primitive_count; /* each has a triangle */
    uint64_t index_count;                      /* of them all */
    uint32_t skipped_lines, skipped_points;    /* primitives that are no triangles */
};

struct gltf_node {    /* depth first: a node's sub-tree are the nodes [node, end) */
    char *name;       /* "" where it has none */
    int parent, mesh; /* or -1 */
    uint32_t end;
    uint32_t number;  /* in the file's list; instances below a node have its number */
    double world[16]; /* column-major */
};

struct gltf_texture {
    uint32_t image;
    bool srgb, wrap_repeat;
};

struct gltf_image {
    char *name;
    unsigned char *bytes; /* as it lies in the file: PNG, JPEG */
    size_t size;
};

struct gltf_model {
    struct gltf_primitive *primitives;
    struct gltf_mesh *meshes;
    struct gltf_node *nodes; /* of the default scene */
    struct asset_material *materials;
    char **material_names;
    struct gltf_texture *textures; /* what the materials' numbers mean; one per use of an image */
    struct gltf_image *images;
    uint32_t primitive_count, mesh_count, node_count, material_count, texture_count, image_count;
    uint32_t skipped_lines, skipped_points; /* of all meshes */
    uint32_t scaled_rotations;              /* of nodes and instances: their length is not 1 */
    char **left_out; /* a text for each use of a texture, and each extension, that is left out */
    uint32_t left_out_textures;
};

/* Parses and decodes a model file. Returns false with the reason, by object name and number, in why; then there is nothing to free. */
bool gltf_load(struct gltf_model *model, const struct model_source *source, char why[MODEL_WHY_BYTES]);
/* Frees the model. */
void gltf_free(struct gltf_model *model);

#ifdef __cplusplus
}
#endif
#endif
