/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One asset's mesh cut out of a model: the sub-trees of the nodes that a pattern names, in the asset frame, ready to be drawn. Thread: any;
   a geometry is changed by one thread at a time. */
#ifndef PREPROCESS_GEOMETRY_H
#define PREPROCESS_GEOMETRY_H
#include "base/text/text.h"
#include "plant/plant.h"
#include "preprocess/model/gltf_shim.h"

struct geometry {
    double origin_m[3]; /* the middle of its box; positions are relative to it */
    float (*positions_m)[3];
    float (*normals)[3];
    float (*texcoords)[2];        /* NULL: no part has any */
    float (*second_texcoords)[2]; /* NULL: likewise */
    uint8_t (*colors)[4];         /* NULL: likewise */
    uint32_t *indices;
    struct asset_primitive *primitives;
    struct asset_material *materials;
    struct asset_texture *textures;
    uint8_t *texels;
    struct text names;
    uint32_t vertex_count, index_count, primitive_count, material_count, texture_count;
    size_t texel_bytes;
    /* For the report: nodes taken, triangles without area, triangles that were turned (winding.h), places that were moved (gaps.h),
       primitives that had no normals, primitives that are no triangles. */
    uint32_t node_count, degenerate_triangles, turned_triangles, closed_gaps, computed_normals, skipped_lines, skipped_points;
};

struct geometry_params {
    const char *nodes; /* patterns (plant/models/nodes.h); NULL: all */
    double unit_m;
    enum axis up;
    double tolerance_m; /* no wider gaps are closed, in what is drawn and when distances are found; 0: chosen from the model */
};

/* Builds the asset's mesh from the model. Returns false with the reason in why, and then there is nothing to finish. */
bool geometry_cut(struct geometry *geometry, const struct gltf_model *model, const struct geometry_params *params,
                  char why[MODEL_WHY_BYTES]);
/* Frees the mesh. */
void geometry_finish(struct geometry *geometry);

/* Computes a hash of everything that geometry_cut() would take from the model (not of params), so that a changed model whose asset is
   unchanged gives the same hash. Returns false as geometry_cut() does. */
bool geometry_hash(uint64_t *out, const struct gltf_model *model, const struct geometry_params *params, char why[MODEL_WHY_BYTES]);

/* Returns how many triangles geometry_cut() would read, including those without area; 0 where it would find nothing. Quick: for estimating
   work. */
uint64_t geometry_triangles(const struct gltf_model *model, const struct geometry_params *params);

/* Returns, for each node of the model, the bounding box of its sub-tree's meshes in the asset frame (low, high); infinite where it has
   none. The caller frees it (mem_free). */
double (*geometry_node_boxes(const struct gltf_model *model, const struct geometry_params *params))[2][3];

/* Finds the position, in the asset frame, of the node that `pattern` names: the centre of its sub-tree's bounding box, or its origin if it
   has no mesh; of the whole asset for "". Nodes inside the asset are preferred. Returns false with the reason in why if there is none, or
   several in different positions. */
bool geometry_node_place(const struct gltf_model *model, const struct geometry_params *params, const char *pattern, double place_m[3],
                         char why[MODEL_WHY_BYTES]);

#endif
