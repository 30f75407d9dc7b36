/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One of the two plants in a comparison: a plant file with its models, or a folder of prepared files. Call from one thread only. */
#ifndef PREPROCESS_DIFF_SIDE_H
#define PREPROCESS_DIFF_SIDE_H
#include "base/text/diag.h"
#include "preprocess/cache/folder.h"
#include "preprocess/model/model_files.h"
#include "plant/models/model_refusal.h"

struct diff_side_tag {
    const char *name;
    const char *asset; /* asset id in the tag's row of the tag list, even if the plant has no such asset; "": none */
    size_t column;     /* index of the tag's sensor among the sensors of its asset */
    bool is_sensor;
};

struct diff_side_asset {
    const char *id;
    double placement[16]; /* transform from the asset frame to the plant frame */
    uint64_t work;        /* identifies the asset's model; assets with equal values use the same model */
    /* plant file's entry of the asset; this and the members below are set only if the plant was read from a plant file */
    const struct plant_asset *plant;
    size_t model;
    /* key of the asset's prepared file; set only if a folder of prepared files is compared */
    uint64_t key;
    const char *missing; /* why the asset has no prepared file; NULL: it has one */
    bool reported;       /* an error message has said that the asset's file cannot be read */
};

struct diff_side {
    const char *path;
    struct diff_side_asset *assets;
    struct diff_side_tag *tags; /* tags of the plant, sorted by name */
    size_t asset_count, tag_count;
    struct plant *plant; /* the plant read from a plant file; NULL: a folder of prepared files is compared */
    struct model_files models;
    struct model_file *parsed; /* the parsed model file in memory; only one at a time */
    char *manifest;            /* text of the manifest; the strings of the assets and tags belong to `root`, the parsed manifest */
    void *root;
};

/* Opens one of the two plants, a plant file or a folder of prepared files, and lists its assets and tags. Returns false with
 * the reason in diag. In either case, call diff_side_finish(). */
bool diff_side_open(struct diff_side *side, const char *path, struct diag *diag);
/* Frees the lists of assets and tags, and the model in memory. */
void diff_side_finish(struct diff_side *side);
/* Returns the tag with this name, or NULL. The tag belongs to `side`. */
const struct diff_side_tag *diff_side_find_tag(const struct diff_side *side, const char *name);

struct diff_side_shape { /* triangles and sensor positions of an asset, relative to origin_m in the asset frame */
    double origin_m[3];
    const float (*positions_m)[3];
    const uint32_t *indices;
    size_t vertex_count, index_count;
    double (*places_m)[3]; /* positions of the asset's sensors; NaN if a sensor's node does not exist */
    char **whys;           /* by sensor: reason why its node is missing or ambiguous; NULL: the sensor's position is known */
    size_t sensor_count;
    bool unreadable; /* true: there is no shape because a model or a prepared file cannot be read */
    bool own;        /* true: this struct owns its arrays; false: they point into the mapped file */
    struct folder_file file;
};
/* Reads an asset's triangles and sensor positions into *shape. Returns false with the reason in why if they cannot be read; otherwise call
 * diff_side_shape_finish(). */
bool diff_side_shape(struct diff_side *side, const struct diff_side_asset *asset, struct diff_side_shape *shape, char why[MODEL_WHY_BYTES]);
/* A bounding box in the asset frame, metres. */
struct diff_side_box {
    double low_m[3], high_m[3];
};
/* Searches the asset's model, from node index *node on, for a node whose subtree has this bounding box (asset frame) within
 * tolerance_m. Writes the index of the node to *node, and its quoted name to name ("#number" if the name is not unique).
 * Returns false if there is no such node, or if this plant is a folder of prepared files. */
bool diff_side_node_in_box(struct diff_side *side, const struct diff_side_asset *asset, const struct diff_side_box *box, double tolerance_m,
                           uint32_t *node, char *name, size_t name_bytes);
/* Like diff_side_shape(), but reads the triangles of model node `node` instead of the asset's, and no sensors. */
bool diff_side_shape_of_node(struct diff_side *side, const struct diff_side_asset *asset, uint32_t node, struct diff_side_shape *shape,
                             char why[MODEL_WHY_BYTES]);
/* Frees the shape's arrays, or unmaps the file that they point into. */
void diff_side_shape_finish(struct diff_side_shape *shape);

#endif
