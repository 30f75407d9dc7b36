/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The mesh of one asset, cut out of a model: the subtrees of the nodes that the patterns select, in the asset frame (metres, Z
 * up), ready to draw. Call from any thread; only one thread may change a geometry at a time. */
#ifndef PREPROCESS_GEOMETRY_H
#define PREPROCESS_GEOMETRY_H
#include "base/text/text.h"
#include "plant/plant.h"
#include "preprocess/model/gltf_shim.h"

struct geometry {
    double origin_m[3]; /* centre of the mesh's bounding box; vertex positions are relative to it */
    float (*positions_m)[3];
    float (*normals)[3];
    float (*texcoords)[2];        /* texture coordinates of the vertices; NULL: no primitive has any */
    float (*second_texcoords)[2]; /* second set of texture coordinates of the vertices; NULL: no primitive has one */
    uint8_t (*colors)[4];         /* vertex colours; NULL: no primitive has any */
    uint32_t *indices;
    struct asset_primitive *primitives;
    struct asset_material *materials;
    struct asset_texture *textures;
    uint8_t *texels;
    struct text names;
    uint32_t vertex_count, index_count, primitive_count, material_count, texture_count;
    size_t texel_bytes;
    /* Counts for the report: selected nodes, triangles without area, triangles turned (winding.h), positions moved (gaps.h), primitives
     * without normals, line primitives, point primitives. */
    uint32_t node_count, degenerate_triangles, turned_triangles, closed_gaps, computed_normals, skipped_lines, skipped_points;
};

struct geometry_params {
    const char *nodes; /* patterns of the nodes to cut out (plant/models/nodes.h); NULL: all nodes */
    double unit_m;
    enum axis up;
    /* widest gap to close, in metres, both in the drawn mesh and in the mesh on which distances along the surface are computed;
       0: chosen from the model's size */
    double tolerance_m;
};

/* Builds the asset's mesh from the model. Returns false with the reason in why; geometry_finish() then need not be called. */
bool geometry_cut(struct geometry *geometry, const struct gltf_model *model, const struct geometry_params *params,
                  char why[MODEL_WHY_BYTES]);
/* Frees the arrays of the asset's mesh. */
void geometry_finish(struct geometry *geometry);

/* Hashes everything that geometry_cut() takes from the model, but not params: if a model changes outside the asset, the hash
 * stays the same. Returns false with the reason in why if geometry_cut() would fail. */
bool geometry_hash(uint64_t *out, const struct gltf_model *model, const struct geometry_params *params, char why[MODEL_WHY_BYTES]);

/* Returns the number of triangles that geometry_cut() would read, including those without area; 0 if it would find none. Fast;
 * used to estimate how long preparing the asset takes. */
uint64_t geometry_triangles(const struct gltf_model *model, const struct geometry_params *params);

/* Returns whether any triangle of the node's own mesh has an area. geometry_cut() refuses an asset whose nodes all have no area. */
bool geometry_node_has_area(const struct gltf_model *model, uint32_t node);

/* Returns, for each node of the model, the bounding box (low, high) of its subtree's meshes in the asset frame; an infinite box
 * if there are none. The caller frees the array (mem_free). */
double (*geometry_node_boxes(const struct gltf_model *model, const struct geometry_params *params))[2][3];

/* Finds the position, in the asset frame, of the node that `pattern` matches: the centre of its subtree's bounding box, or its
 * origin if it has no mesh; for "", the centre of the whole asset. Prefers nodes inside the asset. Returns false with the
 * reason in why if no node matches, or if several match at different positions. */
bool geometry_node_place(const struct gltf_model *model, const struct geometry_params *params, const char *pattern, double place_m[3],
                         char why[MODEL_WHY_BYTES]);

#endif
