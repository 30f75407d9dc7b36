/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares the vertices of a model before and after a revision to find how far each part has moved. Lengths and axes are in the
 * model's units and frame. Call from any thread; each struct from one thread at a time. */
#ifndef PREPROCESS_IMPORT_MODEL_STATES_H
#define PREPROCESS_IMPORT_MODEL_STATES_H
#include "preprocess/import/revision/node_pairs.h"
#include "preprocess/model/gltf_shim.h"

struct model_state { /* a model before or after a revision, loaded into memory */
    struct model_outline outline;
    struct gltf_model model;
    /* by node of the outline: index in `model` of its first instance; its other instances follow directly and have the same node number */
    uint32_t *first;
    bool read;
};

struct model_states {
    struct model_state before, after;
    struct node_pairs pairs;
};

/* Reads the model files before and after a revision and pairs their nodes. Returns false with the reason in why. In either
 * case, call model_states_finish(). */
bool model_states_read(struct model_states *states, const char *before, const char *after, char why[MODEL_WHY_BYTES]);
void model_states_finish(struct model_states *states);

enum states_change {
    STATES_SAME,
    STATES_MOVED,
    STATES_CHANGED /* the part's shape differs; the motion is that of its bounding box, and is known only if the box kept its size */
};
struct states_motion {
    enum states_change change;
    bool known; /* true: the asset's motion between the two models could be determined */
    double motion[16], moved;
    /* parts: number of the asset's nodes with geometry; different: number of these that are missing from the new model or have
     * another shape there */
    size_t parts, different;
};
/* Determines an asset's motion: the motion shared by the old model's nodes marked in `taken`. Distances below `tolerance` count
 * as no change. */
struct states_motion model_states_motion(const struct model_states *states, const bool *taken, double tolerance);
/* Returns the node of the old model whose triangles are nearest to a point, among those marked in `taken`; -1 if these have no
 * triangles. */
int model_states_nearest(const struct model_states *states, const bool *taken, const double point[3]);

#endif
