/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One asset cut out of a model: the nodes that a pattern names with their sub-trees, in the asset frame, ready to be drawn. */
#ifndef PREPROCESS_GEOMETRY_H
#define PREPROCESS_GEOMETRY_H
#include "base/text.h"
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
    /* For the report: nodes taken, triangles without area, primitives that had no normals, primitives that are no triangles. */
    uint32_t node_count, degenerate_triangles, computed_normals, skipped_lines, skipped_points;
};

struct geometry_params {
    const char *nodes; /* patterns (plant/nodes.h); NULL: all */
    double unit_m;
    enum axis up;
    double tolerance_m; /* not for cutting: gaps up to this are closed when distances are found; 0: chosen from the model */
};

/* False: why says what is wrong; nothing to finish. */
bool geometry_cut(struct geometry *geometry, const struct gltf_model *model, const struct geometry_params *params,
                  char why[MODEL_WHY_BYTES]);
void geometry_finish(struct geometry *geometry);

/* A hash of all that geometry_cut would take from the model, whatever else is in it; not of params. False: as geometry_cut. */
bool geometry_hash(uint64_t *out, const struct gltf_model *model, const struct geometry_params *params, char why[MODEL_WHY_BYTES]);

/* How many triangles that would take, before those without area are left out. 0 where geometry_cut would find nothing. */
uint64_t geometry_triangles(const struct gltf_model *model, const struct geometry_params *params);

/* Of each node: the box around its sub-tree's meshes in the asset frame, low and high; infinite where there is none. Free with mem_free. */
double (*geometry_node_boxes(const struct gltf_model *model, const struct geometry_params *params))[2][3];

/* The place of the node that a pattern names, in the asset frame: the middle of the box around its sub-tree's meshes, else its origin.
   Nodes inside the asset are preferred to others. False: why says that there is none, or that several stand in different places. */
bool geometry_node_place(const struct gltf_model *model, const struct geometry_params *params, const char *pattern, double place_m[3],
                         char why[MODEL_WHY_BYTES]);

#endif
