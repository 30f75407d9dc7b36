/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files that cut an asset out of a model (geometry*.c). */
#ifndef PREPROCESS_GEOMETRY_IMPL_H
#define PREPROCESS_GEOMETRY_IMPL_H
#include "preprocess/geometry/geometry.h"

struct node_primitive { /* one primitive under one node */
    const struct gltf_node *node;
    const struct gltf_primitive *primitive;
    uint32_t order;
    bool blend;
};

struct node_primitives {
    struct node_primitive *at; /* sorted by material, blended ones last */
    size_t count, capacity;
};
/* Of the nodes that params take; counts of nodes and of what is skipped go to geometry. False: why says what is wrong. mem_free(parts->at)
   in both cases. */
bool node_primitives_find(struct node_primitives *parts, struct geometry *geometry, const struct gltf_model *model,
                          const struct geometry_params *params, char *why);

struct vertex { /* every attribute, so that vertices are welded only where all agree */
    float position[3], normal[3], texcoord[2], second_texcoord[2];
    uint8_t color[4];
};

struct primitive_mesh {
    struct vertex *vertices; /* one per corner at first */
    unsigned *indices;
    size_t vertex_count, index_count;
};

/* The asset frame from a node's own: units, axes and the node's place. */
void primitive_world(const struct geometry_params *params, const struct gltf_node *node, double out[16]);

/* Its triangles in the asset frame, less the origin, welded and in an order that suits a vertex cache. False: out of memory. Finish in
   both cases. */
bool primitive_mesh(struct primitive_mesh *mesh, const struct node_primitive *part, const struct geometry_params *params,
                    struct geometry *geometry);
void primitive_mesh_finish(struct primitive_mesh *mesh);

/* Decodes the textures that the geometry's materials use, and renumbers these; false: why says what is wrong. */
bool geometry_join_textures(struct geometry *geometry, const struct gltf_model *model, char *why);

#endif
