/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the nodes of a glTF file and their bounding boxes from its JSON, without the vertices, so that plantcastd --check is
   fast. Call from any thread. */
#ifndef PLANT_MODELS_MODEL_HEADER_H
#define PLANT_MODELS_MODEL_HEADER_H
#include "plant/models/nodes.h"

struct model_box { /* axis-aligned bounding box; empty if a coordinate of its low corner is greater than that of the high corner */
    double low[3], high[3];
};

struct model_header {
    struct model_node *nodes; /* nodes of the scene, each directly followed by its descendants */
    struct model_box *boxes;  /* bounding box of each node's own mesh in scene coordinates, in the model's units and axes */
    double (*origins)[3];     /* origin of each node's own frame in scene coordinates, in the model's units and axes */
    size_t count;
    bool partial; /* true: boxes may be too small, because the model has instances, or accessors without bounds (min and max) */
    void *json;   /* parsed JSON of the model file; owns the names */
};

/* Reads a file. On failure, returns false with the reason in `why`; model_header_finish() is then not needed. */
bool model_header_read(struct model_header *header, const char *path, char *why, size_t why_bytes);
/* Returns the number of triangles of the node's own mesh, from the counts of its accessors. */
uint64_t model_header_triangles(const struct model_header *header, size_t node);
void model_header_finish(struct model_header *header);

extern const struct model_box model_box_empty;
/* Enlarges a bounding box so that it contains another box. */
void model_box_add(struct model_box *box, const struct model_box *other);

#endif
