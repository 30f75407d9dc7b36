/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The whole model under construction: a tree of named nodes, meshes that nodes may share, and nozzles to which pipes connect. */
#ifndef GENERATE_MODEL_H
#define GENERATE_MODEL_H
#include "material.h"
#include "mesh.h"

struct model_mesh {
    char *name;
    enum material material;
    struct mesh mesh;
};

struct model_node {
    char *name;
    int parent;      /* index; -1: below the root */
    int mesh;        /* index, or -1 */
    struct frame at; /* in the parent's frame */
};

struct model_nozzle {
    char *name;      /* ASSET/NOZZLE */
    struct frame at; /* plant frame: origin on the flange face, z outward */
    double r;        /* of the pipe, outside */
};

struct model { /* zero-initialise */
    struct model_mesh **meshes;
    struct model_node *nodes;
    struct model_nozzle *nozzles;
    size_t mesh_count, mesh_capacity, node_count, node_capacity, nozzle_count, nozzle_capacity;
};

struct item { /* an asset under construction; its parts are built in its own frame */
    struct model *model;
    char *name;
    int node;
    struct frame at;             /* plant frame */
    struct mesh *necks, *flanges; /* where item_nozzle builds */
};

void model_finish(struct model *model);
int model_add_node(struct model *model, const char *name, int parent, int mesh, struct frame at);
int model_find_node(const struct model *model, const char *name); /* or -1 */
int model_add_mesh(struct model *model, const char *name, enum material material);
const struct model_nozzle *model_nozzle(const struct model *model, const char *name); /* a missing one is our bug: aborts */

struct item item_begin(struct model *model, const char *name, struct frame at);
/* A group of parts with a frame of its own (plant frame) below another asset. */
struct item item_begin_group(struct item *asset, const char *name, struct frame at);
void item_end(struct item *item);
/* The mesh of the child node `NAME part`, made on first call. */
struct mesh *item_part(struct item *item, const char *part, enum material material);
/* Names a place to which a pipe connects; at: item frame. */
void item_connect(struct item *item, const char *nozzle, struct frame at, double r);
/* A second node tree with the meshes and nozzles of `original`. */
void model_add_instance(struct model *model, const char *name, const char *original, struct frame at);

#endif
