/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One of the two plants that a comparison reads: a plant file with its models, or a folder of prepared files. Thread: one. */
#ifndef PREPROCESS_DIFF_SIDE_H
#define PREPROCESS_DIFF_SIDE_H
#include "base/text/diag.h"
#include "preprocess/cache/folder.h"
#include "preprocess/model/model_files.h"
#include "preprocess/model/refusal.h"

struct diff_side_tag {
    const char *name;
    const char *asset; /* the id that its row names, whether there is such an asset; "" for none */
    size_t column;     /* among the sensors of its asset */
    bool is_sensor;
};

struct diff_side_asset {
    const char *id;
    double placement[16]; /* plant from asset frame */
    uint64_t work;        /* assets with equal numbers are of one model */
    /* of a plant file: */
    const struct plant_asset *plant;
    size_t model;
    /* of a folder: */
    uint64_t key;
};

struct diff_side {
    const char *path;
    struct diff_side_asset *assets;
    struct diff_side_tag *tags; /* sorted by name */
    size_t asset_count, tag_count;
    struct plant *plant; /* NULL: a folder */
    struct model_files models;
    struct model_file *parsed; /* the one in memory */
    char *manifest;            /* as it was read; names point into root */
    void *root;
};

/* Opens a plant file or a folder of prepared files and lists its assets and tags. Returns false with the reason in diag. Call
   diff_side_finish() in both cases. */
bool diff_side_open(struct diff_side *side, const char *path, struct diag *diag);
/* Frees the lists and releases a model that is still in memory. */
void diff_side_finish(struct diff_side *side);
/* Returns the tag of this name, or NULL. Belongs to the side. */
const struct diff_side_tag *diff_side_find_tag(const struct diff_side *side, const char *name);

struct diff_side_shape { /* an asset's triangles, and where its sensors are; less origin_m, asset frame */
    double origin_m[3];
    const float (*positions_m)[3];
    const uint32_t *indices;
    size_t vertex_count, index_count;
    double (*places_m)[3]; /* of its sensors; NaN where the node is not there */
    char **whys;           /* why a node is not there, or not the only one; else NULL */
    size_t sensor_count;
    bool own; /* the arrays are a geometry's */
    struct folder_file file;
};
/* Reads an asset's triangles and sensor positions into *shape. Returns false if the plant does not have them, with the reason in why; else
   finish it with diff_side_shape_finish(). */
bool diff_side_shape(struct diff_side *side, const struct diff_side_asset *asset, struct diff_side_shape *shape, char why[MODEL_WHY_BYTES]);
/* A bounding box in the asset frame, metres. */
struct diff_side_box {
    double low_m[3], high_m[3];
};
/* Searches the asset's model, from *node on, for a node whose sub-tree has this bounding box (asset frame) to tolerance_m. Writes its
   number to *node and its quoted name, or its number where the name is not unique, to name. Returns false if there is none, or if the side
   is a folder. */
bool diff_side_node_in_box(struct diff_side *side, const struct diff_side_asset *asset, const struct diff_side_box *box, double tolerance_m,
                           uint32_t *node, char *name, size_t name_bytes);
/* As diff_side_shape(), for the triangles of model node `node` in place of the asset's own, without sensors. */
bool diff_side_shape_of_node(struct diff_side *side, const struct diff_side_asset *asset, uint32_t node, struct diff_side_shape *shape,
                             char why[MODEL_WHY_BYTES]);
/* Frees or unmaps what the shape holds. */
void diff_side_shape_finish(struct diff_side_shape *shape);

#endif
