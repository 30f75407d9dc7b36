/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a model says of itself before its vertices are read: its nodes and their boxes, out of the JSON of a glTF file. For --check, which
   has no time for more; plantcast-prep reads models with gltf_shim.h and finds what is not seen here. Thread: any. */
#ifndef PLANT_MODEL_HEADER_H
#define PLANT_MODEL_HEADER_H
#include "plant/nodes.h"

struct model_box { /* low > high: empty */
    double low[3], high[3];
};

struct model_header {
    struct model_node *nodes; /* of the scene, depth first */
    struct model_box *boxes;  /* of each node's own mesh, in the model's units and axes, where the scene has it */
    size_t count;
    bool partial;             /* boxes are smaller than the model: instances, or accessors that do not say their range */
    void *json;               /* the names are in it */
};

/* False: why says what is wrong with the file; nothing to finish. */
bool model_header_read(struct model_header *header, const char *path, char *why, size_t why_bytes);
void model_header_finish(struct model_header *header);

extern const struct model_box model_box_empty;
void model_box_add(struct model_box *box, const struct model_box *other);

#endif
