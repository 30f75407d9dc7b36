/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes GLB files (glTF 2.0) of coloured, unlit (KHR_materials_unlit) triangles, lines and points. Use each writer in one thread only. */
#ifndef PREPROCESS_DEBUG_GLB_WRITER_H
#define PREPROCESS_DEBUG_GLB_WRITER_H
#include <stdint.h>

#include "base/text/text.h"

enum glb_mode { GLB_POINTS = 0, GLB_LINES = 1, GLB_TRIANGLES = 4 };

struct glb_shape { /* triangles, lines or points of one node; Y is up */
    enum glb_mode mode;
    const float (*positions)[3];
    const uint16_t (*colors)[4]; /* colours of the vertices, linear, 65535 is 1; NULL: `color` applies to all vertices */
    const uint32_t *indices;     /* vertex indices; NULL: the vertices are used in order */
    size_t vertex_count, index_count;
    uint8_t color[3]; /* sRGB colour of all vertices if `colors` is NULL */
};

struct glb_writer;

/* Creates an empty scene whose root node is named `name`. The caller frees it with glb_writer_destroy(). */
struct glb_writer *glb_writer_create(const char *name);
/* Frees the writer and sets *writer to NULL. *writer may be NULL. */
void glb_writer_destroy(struct glb_writer **writer);
/* Copies a shape into the scene as a child of the root, under this name. Ignores a shape without vertices. */
void glb_writer_add(struct glb_writer *writer, const char *name, const struct glb_shape *shape);
/* Writes the scene to `path`. Returns 0 or -errno. */
int glb_writer_save(struct glb_writer *writer, const char *path);

/* Converts an 8-bit sRGB component to a linear one, where 65535 is 1.0. */
uint16_t glb_linear(uint8_t srgb);

#endif
