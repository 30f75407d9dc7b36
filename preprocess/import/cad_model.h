/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A CAD model in memory, before it is written as glTF: a tree of named nodes with attributes, triangles and lines. Format
 * readers (rvm.h) fill it; cad_glb.h writes it. One thread per model. Lengths are in metres, Z is up, positions are plant
 * coordinates. */
#ifndef PREPROCESS_IMPORT_CAD_MODEL_H
#define PREPROCESS_IMPORT_CAD_MODEL_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct cad_vertex {
    double position_m[3];
    float normal[3]; /* unit vector */
};

struct cad_attribute {
    char *name, *value; /* name and value of an attribute, UTF-8 */
};

struct cad_node {
    char *name; /* name of the node, UTF-8; "": it has none */
    int parent; /* index of the parent, always lower than the node's own; -1: the node is a root */
    uint32_t material;
    struct cad_vertex *vertices;
    uint32_t (*triangles)[3];
    double (*lines_m)[2][3];
    struct cad_attribute *attributes;
    size_t vertex_count, vertex_room, triangle_count, triangle_room, line_count, line_room, attribute_count, attribute_room;
};

struct cad_color {
    uint32_t material;
    uint8_t rgb[3]; /* red, green and blue, sRGB */
};

struct cad_model {
    struct cad_node *nodes; /* nodes: parents before children, siblings in the order of the file */
    struct cad_color *colors;
    size_t node_count, node_room, color_count, color_room;
};

/* Creates an empty model, which the caller frees with cad_model_destroy(). */
struct cad_model *cad_model_create(void);
/* Frees the CAD model with its nodes, and sets *model to NULL. *model may be NULL. */
void cad_model_destroy(struct cad_model **model);

/* Appends a node to the model below the node `parent` (-1: a root) and returns its index. Copies `name`. */
int cad_model_add_node(struct cad_model *model, int parent, const char *name);
/* Appends a vertex to the node and returns its index in the node. `normal` need not be normalised; a zero vector becomes (0, 0, 1). */
uint32_t cad_node_add_vertex(struct cad_node *node, const double position_m[3], const double normal[3]);
void cad_node_add_triangle(struct cad_node *node, uint32_t a, uint32_t b, uint32_t c);
void cad_node_add_line(struct cad_node *node, const double from_m[3], const double to_m[3]);
/* Appends an attribute to the node. Copies both texts. */
void cad_node_add_attribute(struct cad_node *node, const char *name, const char *value);
void cad_model_add_color(struct cad_model *model, uint32_t material, const uint8_t rgb[3]);

#endif
