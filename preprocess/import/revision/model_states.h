/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model before and after a revision, with vertices: how far each part of it has moved. Units and axes are the model's. Thread: any, one
 * per states. */
#ifndef PREPROCESS_IMPORT_MODEL_STATES_H
#define PREPROCESS_IMPORT_MODEL_STATES_H
#include "preprocess/import/revision/node_pairs.h"
#include "preprocess/model/gltf_shim.h"

struct model_state { /* the new one, or the old one */
    struct model_outline outline;
    struct gltf_model model;
    uint32_t *first; /* by node of the outline, the node of the model; instances of it come after it, with the same number */
    bool read;
};

struct model_states {
    struct model_state before, after;
    struct node_pairs pairs;
};

/* Reads both files and pairs their nodes. Returns false with the reason in why; finish it in both cases. */
bool model_states_read(struct model_states *states, const char *before, const char *after, char why[MODEL_WHY_BYTES]);
void model_states_finish(struct model_states *states);

enum states_change {
    STATES_SAME,
    STATES_MOVED,
    STATES_CHANGED /* in shape; motion is that of its box, if that has kept its size */
};
struct states_motion {
    enum states_change change;
    bool known; /* motion is where things on it have gone */
    double motion[16], moved;
    size_t parts, different; /* nodes that show something; those among them that are gone or have another shape */
};
/* Finds what became of those nodes of the old model that `taken` marks, taken as one. tolerance: distances below it are no change. */
struct states_motion model_states_motion(const struct model_states *states, const bool *taken, double tolerance);
/* Returns the node of the old model, among those that `taken` marks, whose triangles are nearest to a point; -1: they have none. */
int model_states_nearest(const struct model_states *states, const bool *taken, const double point[3]);

#endif
