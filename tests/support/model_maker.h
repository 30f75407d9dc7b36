/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes glTF models piece by piece: JSON and binary data grow together. */
#ifndef TESTS_MODEL_MAKER_H
#define TESTS_MODEL_MAKER_H
#include <jansson.h>

#include "base/text/text.h"
#include "tests/support/cad.h"

enum { BYTE = 5120, UBYTE = 5121, SHORT = 5122, USHORT = 5123, UINT = 5125, FLOAT = 5126 };

struct model_maker {
    json_t *root;
    struct text bin;
};

void maker_init(struct model_maker *maker);
void maker_finish(struct model_maker *maker);

/* Functions that return int append something and return its index. Lists in the JSON are created as needed. */
int maker_add(struct model_maker *maker, const char *list, json_t *object);
/* appends a buffer view over these bytes; stride 0: the view states no stride */
int maker_view(struct model_maker *maker, const void *bytes, size_t count, int stride);
int maker_accessor(struct model_maker *maker, int view, int component_type, size_t count, const char *type);
int maker_numbers(struct model_maker *maker, const void *bytes, size_t size, int component_type, size_t count,
                  const char *type); /* appends a buffer view over these bytes and an accessor for the view */
int maker_mesh(struct model_maker *maker, json_t *primitive);
/* appends a mesh of one primitive: triangles */
int maker_triangles(struct model_maker *maker, const float (*positions)[3], size_t vertex_count, const uint32_t *indices,
                    size_t index_count);
int maker_node(struct model_maker *maker, const char *name, int mesh, json_t *more); /* a root node; more: further properties, or NULL */
void maker_cad(struct model_maker *maker, const char *node, const struct cad *cad); /* appends a root node that has this shape */
void maker_require(struct model_maker *maker, const char *extension);
json_t *maker_get(struct model_maker *maker, const char *list, int number);

/* maker_glb() returns the model as a GLB file; maker_gltf() returns it as JSON whose buffer is a data URI. The caller frees
   both with mem_free(). */
char *maker_glb(struct model_maker *maker, size_t *size);
char *maker_gltf(struct model_maker *maker, size_t *size);
char *maker_data_uri(const char *kind, const void *bytes, size_t count);

/* Writes the model to FOLDER/NAME as a GLB, and finishes the maker. */
void maker_write(struct model_maker *maker, const char *folder, const char *name);
/* Writes a model of one node that has this shape. */
void maker_write_cad(const char *folder, const char *name, const char *node, const struct cad *cad);

#endif
