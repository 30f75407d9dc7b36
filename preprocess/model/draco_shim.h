/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draco's decoder behind plain C. */
#ifndef PREPROCESS_MODEL_DRACO_SHIM_H
#define PREPROCESS_MODEL_DRACO_SHIM_H
#include <stddef.h>
#include <stdint.h>

#include "preprocess/model/refusal.h"

#ifdef __cplusplus
extern "C" {
#endif

struct draco_mesh;

/* NULL: why says what is wrong. */
struct draco_mesh *draco_mesh_decode(const void *bytes, size_t size, char why[MODEL_WHY_BYTES]);
void draco_mesh_destroy(struct draco_mesh **mesh);

uint32_t draco_mesh_vertex_count(const struct draco_mesh *mesh);
uint32_t draco_mesh_triangle_count(const struct draco_mesh *mesh);
void draco_mesh_indices(const struct draco_mesh *mesh, uint32_t *out); /* three per triangle */

/* `width` numbers of each vertex, as glTF's component type, tightly packed. False: there is no such attribute, or it is narrower. */
bool draco_mesh_attribute(const struct draco_mesh *mesh, uint32_t unique_id, int component_type, int width, void *out);

#ifdef __cplusplus
}
#endif
#endif
