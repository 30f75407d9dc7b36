/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declarations shared by the files that cut an asset's mesh out of a model (geometry*.c). */
#ifndef PREPROCESS_GEOMETRY_IMPL_H
#define PREPROCESS_GEOMETRY_IMPL_H
#include "preprocess/geometry/geometry.h"

struct node_primitive { /* a primitive of a model as placed by one of the nodes that use it */
    const struct gltf_node *node;
    const struct gltf_primitive *primitive;
    uint32_t order;
    bool blend;
};

struct node_primitives {
    struct node_primitive *at; /* primitives of the asset, sorted by material, transparent materials last */
    size_t count, capacity;
};
/* Lists the glTF primitives of the nodes that params select. Adds the numbers of nodes, and of skipped line and point
 * primitives, to `geometry`. Returns false with the reason in why. In either case, the caller frees parts->at (mem_free). */
bool node_primitives_find(struct node_primitives *parts, struct geometry *geometry, const struct gltf_model *model,
                          const struct geometry_params *params, char *why);

/* A vertex with all attributes; vertices are welded only if all attributes are equal. */
struct geometry_vertex {
    float position[3], normal[3], texcoord[2], second_texcoord[2];
    uint8_t color[4];
};

struct primitive_mesh {
    struct geometry_vertex *vertices; /* one vertex per triangle corner, until welding removes duplicates */
    unsigned *indices;
    size_t vertex_count, index_count;
};

/* Computes the transform from a node's frame to the asset frame: the node's world matrix, followed by the conversion to metres and Z up. */
void primitive_world(const struct geometry_params *params, const struct gltf_node *node, double out[16]);

/* Builds the triangles of one glTF primitive in the asset frame, relative to the geometry's origin, welded and ordered for the
 * GPU's vertex cache. Returns false if out of memory. In either case, call primitive_mesh_finish(). */
bool primitive_mesh(struct primitive_mesh *mesh, const struct node_primitive *part, const struct geometry_params *params,
                    struct geometry *geometry);
/* Frees the arrays of the primitive's mesh. */
void primitive_mesh_finish(struct primitive_mesh *mesh);

/* Decodes the textures that the geometry's materials use into geometry->texels, and updates the materials' texture indices. Returns false
 * with the reason in why. */
bool geometry_join_textures(struct geometry *geometry, const struct gltf_model *model, char *why);

#endif
