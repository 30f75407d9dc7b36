/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A glTF scene in the making: nodes with names, matrices and properties, meshes that several of them may share, materials that are each
 * there once. One thread per scene. */
#ifndef PREPROCESS_GLB_GLB_SCENE_H
#define PREPROCESS_GLB_GLB_SCENE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct glb_scene;

struct glb_scene_triangles {
    const float (*positions)[3];
    const float (*normals)[3]; /* NULL: none */
    size_t vertex_count;
    const uint32_t *corners; /* three for each triangle */
    size_t corner_count;
    int material; /* -1: none */
};

/* Creates an empty scene; `generator` names the program in the file. The caller owns it: glb_scene_destroy. */
struct glb_scene *glb_scene_create(const char *generator);
/* &NULL is fine; leaves NULL. */
void glb_scene_destroy(struct glb_scene **scene);

/* Returns the number of a matt material, seen from both sides, of a linear colour with its opacity. */
int glb_scene_material(struct glb_scene *scene, const double rgba[4]);
/* Adds a mesh and returns its number. It must get triangles before the scene is written. */
int glb_scene_add_mesh(struct glb_scene *scene, const char *name);
/* Adds triangles of one material to a mesh; all is copied. */
void glb_scene_add_triangles(struct glb_scene *scene, int mesh, const struct glb_scene_triangles *triangles);
/* Adds a node below `parent` (-1: a root) and returns its number. mesh -1: none. matrix: column-major; NULL: none. */
int glb_scene_add_node(struct glb_scene *scene, int parent, const char *name, int mesh, const double matrix[16]);
/* Sets a property of a node, in its extras. Text that is not UTF-8 is read as Latin-1, as it is in names. */
void glb_scene_set_property(struct glb_scene *scene, int node, const char *key, const char *value);

/* Writes the scene as a GLB file. Returns 0 or -errno (-EFBIG: more than a GLB file can hold). */
int glb_scene_write(struct glb_scene *scene, const char *path);

#ifdef __cplusplus
}
#endif
#endif
