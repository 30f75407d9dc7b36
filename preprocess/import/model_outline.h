/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A GLB file as a tree of named nodes with triangle counts, boxes and properties, read from its JSON without loading vertices.
 * Call from any thread. */
#ifndef PREPROCESS_IMPORT_MODEL_OUTLINE_H
#define PREPROCESS_IMPORT_MODEL_OUTLINE_H
#include <jansson.h>

#include "base/text/text.h"
#include "plant/models/model_header.h"

struct outline_node {
    const char *name;       /* the node's name, else its mesh's name, else ""; not owned */
    const json_t *extras;   /* glTF extras of the node; NULL: none */
    uint64_t triangles;     /* number of triangles of the node's own mesh */
    uint64_t all_triangles; /* number of triangles of the node and of all nodes below it */
    struct model_box all;   /* bounding box of the node and all nodes below it, in the model's units and axes; low > high: no geometry */
    int depth;              /* number of ancestors of the node; 0: it is a root */
    bool unnamed;           /* true: the node has no name of its own */
};

struct model_outline {
    /* tree structure (plant/models/nodes.h): by node, the index of its parent, the index after the last node of its subtree, and
     * "#number" */
    struct model_header header;
    struct outline_node *nodes; /* array of header.count nodes */
    struct model_box box;
    uint64_t triangles;
    size_t unnamed;
};

/* Reads a GLB or glTF file. Returns false with the reason in why; model_outline_finish() then need not be called. */
bool model_outline_read(struct model_outline *outline, const char *path, char *why, size_t why_bytes);
void model_outline_finish(struct model_outline *outline);
/* Sets the triangle count of each node to 0 whose number (index in the glTF file's list of nodes) is marked in by_number. */
void model_outline_leave_out(struct model_outline *outline, const bool *by_number);

/* Returns the value of the text property `name` of a node, from its glTF extras or from a group in them, or NULL if there is none. */
const char *model_outline_property(const struct outline_node *node, const char *name);

/* Appends text to `out`. Control characters and invalid UTF-8 become U+FFFD. */
void model_outline_add_printable(struct text *out, const char *text);

/* Appends the node's name, or "#12" for a node without a name. Control characters become U+FFFD. */
void model_outline_name(const struct model_outline *outline, size_t node, struct text *out);
/* Appends the node's path from the root of the scene: names like those of model_outline_name(), separated by slashes. */
void model_outline_path(const struct model_outline *outline, size_t node, struct text *out);

/* Appends a summary of the model without a line end: "4,679 nodes, 592 unnamed; 52,830 triangles; 21.5 x 22.6 x 3.9 m if the
 * unit is metres and Y is up; 310 m from the origin". If the size is implausible for a plant, adds a hint that the units may be
 * wrong. guessed_m: length in metres of the unit that the import assumed for the source file; 0: the import assumed none. */
void model_outline_summary(const struct model_outline *outline, double guessed_m, struct text *out);

/* Converts a model's bounding box to size and centre in plant axes (Z up: the last number is the height). Returns false for an
 * empty box. */
bool model_outline_extent(const struct model_box *box, double size[3], double centre[3]);

#endif
