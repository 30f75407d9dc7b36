/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rules for the nodes of a glTF scene. plantcast-prep and plantcastd --check apply the same rules. Call from any thread. */
#ifndef PLANT_MODELS_NODE_RULES_H
#define PLANT_MODELS_NODE_RULES_H
#include <stdbool.h>

enum { NODE_MAX_DEPTH = 512, NODE_MAX_COUNT = 4000000 };

/* Computes the transform of a node from translation, rotation (a quaternion of any length but zero) and scale. If `matrix` is
   not NULL, the node's transform is that matrix instead. Returns NULL, or the reason why the node is refused. */
const char *node_rules_local(const double t[3], const double q[4], const double s[3], const double *matrix, double out[16]);
/* Checks the transform `m` from a node to the scene. Returns NULL, or the reason why the node is refused. */
const char *node_rules_world(const double m[16]);
/* Refuses features of glTF nodes that change their shape, such as skins. Returns NULL, or the reason why the node is refused. */
const char *node_rules_shape(bool has_mesh, bool has_skin, bool has_morph_weights);

#endif
