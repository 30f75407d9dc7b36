/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decodes Draco-compressed meshes (KHR_draco_mesh_compression) behind a plain C interface. Call from any thread; each mesh from one
   thread at a time. */
#ifndef PREPROCESS_MODEL_DRACO_SHIM_H
#define PREPROCESS_MODEL_DRACO_SHIM_H
#include <stddef.h>
#include <stdint.h>

#include "plant/models/model_refusal.h"

#ifdef __cplusplus
extern "C" {
#endif

struct draco_mesh;

/* Decodes Draco-compressed data. Returns the mesh, which the caller destroys, or NULL with the reason in why. */
struct draco_mesh *draco_mesh_decode(const void *bytes, size_t size, char why[MODEL_WHY_BYTES]);
/* Frees the mesh and sets *mesh to NULL. *mesh may be NULL. */
void draco_mesh_destroy(struct draco_mesh **mesh);

/* Returns the number of vertices. */
uint32_t draco_mesh_vertex_count(const struct draco_mesh *mesh);
/* Returns the number of triangles. */
uint32_t draco_mesh_triangle_count(const struct draco_mesh *mesh);
/* Writes the mesh's triangles to `out`, three vertex indices each. */
void draco_mesh_indices(const struct draco_mesh *mesh, uint32_t *out);

/* Writes the values of attribute unique_id at all vertices to out, tightly packed: `width` components each, of a glTF component
 * type. Returns false if the mesh has no such attribute or it has fewer components. */
bool draco_mesh_attribute(const struct draco_mesh *mesh, uint32_t unique_id, int component_type, int width, void *out);

#ifdef __cplusplus
}
#endif
#endif
