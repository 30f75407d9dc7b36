/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a glTF model into plain C arrays and validates every number. Hides tinygltf. Call from any thread; each model from one
   thread at a time. */
#ifndef PREPROCESS_MODEL_GLTF_SHIM_H
#define PREPROCESS_MODEL_GLTF_SHIM_H
#include "preprocess/model/model_source.h"
#include "protocol/asset_format.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gltf_primitive { /* triangles of one material, in model units and the mesh's frame */
    uint32_t vertex_count, index_count;
    float (*positions)[3];
    float (*normals)[3];          /* vertex normals; NULL: the primitive has none */
    float (*texcoords)[2];        /* texture coordinates for the material's first mapping (KHR_texture_transform); NULL: none */
    /* coordinates for the textures with the material's second mapping, which are in the bit mask `second` of the material; NULL: none */
    float (*second_texcoords)[2];
    uint8_t (*colors)[4];         /* vertex colours; NULL: none */
    uint32_t *indices;            /* triangle list, converted from strips and fans */
    int material;                 /* index of the primitive's material; -1: none */
};

struct gltf_mesh {
    char *name;
    uint32_t first_primitive, primitive_count; /* range of the mesh's primitives; each has at least one triangle */
    uint64_t index_count;                      /* number of indices in all primitives of the mesh */
    uint32_t skipped_lines, skipped_points;    /* numbers of primitives skipped because they consist of lines or points */
};

struct gltf_node {    /* nodes are in depth-first order: the subtree of node i is the range [i, end) */
    char *name;       /* name of the node; "": it has none */
    int parent, mesh; /* indices of the parent node and of the node's mesh; -1: none */
    uint32_t end;
    uint32_t number;  /* index in the file's list of nodes; an instance (EXT_mesh_gpu_instancing) has its node's index */
    double world[16]; /* column-major transform from the node's frame to the scene's frame */
};

struct gltf_texture {
    uint32_t image;
    bool srgb, wrap_repeat;
};

struct gltf_image {
    char *name;
    unsigned char *bytes; /* bytes of the image as stored in the file: PNG or JPEG */
    size_t size;
};

struct gltf_model {
    struct gltf_primitive *primitives;
    struct gltf_mesh *meshes;
    struct gltf_node *nodes; /* nodes of the default scene */
    struct asset_material *materials;
    char **material_names;
    struct gltf_texture *textures; /* textures that materials refer to, one for each use of an image in a material */
    struct gltf_image *images;
    uint32_t primitive_count, mesh_count, node_count, material_count, texture_count, image_count;
    uint32_t skipped_lines, skipped_points; /* numbers of skipped line and point primitives in all meshes */
    uint32_t scaled_rotations;              /* number of nodes and instances whose rotation quaternion is not of unit length */
    char **left_out;                        /* texts for the report, one for each ignored texture and extension */
    uint32_t left_out_textures;
};

/* Parses and decodes a model file. Returns false with the reason in why, which names the object and the number; gltf_free()
 * then need not be called. */
bool gltf_load(struct gltf_model *model, const struct model_source *source, char why[MODEL_WHY_BYTES]);
/* Frees the arrays of a parsed model. */
void gltf_free(struct gltf_model *model);

#ifdef __cplusplus
}
#endif
#endif
