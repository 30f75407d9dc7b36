/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A GLB file as a tree of named nodes with triangle counts, boxes and properties, read from its JSON alone. Thread: any. */
#ifndef PREPROCESS_IMPORT_MODEL_OUTLINE_H
#define PREPROCESS_IMPORT_MODEL_OUTLINE_H
#include <jansson.h>

#include "base/text/text.h"
#include "plant/models/model_header.h"

struct outline_node {
    const char *name;       /* its own, else its mesh's, else ""; not owned */
    const json_t *extras;   /* NULL: none */
    uint64_t triangles;     /* its own */
    uint64_t all_triangles; /* with all below it */
    struct model_box all;   /* box of all below it too, in the model's units and axes; low > high: it shows nothing */
    int depth;              /* 0: a root */
    bool unnamed;           /* it has no name of its own */
};

struct model_outline {
    struct model_header header; /* parents, ends and numbers of the nodes */
    struct outline_node *nodes; /* header.count of them */
    struct model_box box;
    uint64_t triangles;
    size_t unnamed;
};

/* Reads a GLB or glTF file. Returns false with the reason in why, and then there is nothing to finish. */
bool model_outline_read(struct model_outline *outline, const char *path, char *why, size_t why_bytes);
void model_outline_finish(struct model_outline *outline);

/* Returns the value of a property that is text, on the first or the second level of the node's extras, or NULL. */
const char *model_outline_property(const struct outline_node *node, const char *name);

/* Appends the text with U+FFFD for control characters and what is not UTF-8. */
void model_outline_add_printable(struct text *out, const char *text);

/* Appends the node's path from the top of the scene: names with slashes between them, "#12" for a node without one. Control characters
 * become U+FFFD. */
void model_outline_path(const struct model_outline *outline, size_t node, struct text *out);

/* Appends what a person must know first: "4,679 nodes, 592 unnamed; 52,830 triangles; 21.5 x 22.6 x 3.9 m if metres, up y; 310 m from the
 * origin", and a question if that is hardly the size of a plant and the units may be others. No line end. */
void model_outline_summary(const struct model_outline *outline, struct text *out);

/* Turns a box into size and centre in the frame of a plant: Z up, the last number is the height. Returns false for an empty box. */
bool model_outline_extent(const struct model_box *box, double size[3], double centre[3]);

#endif
