/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds a glTF scene: named nodes with matrices and properties; meshes that nodes can share; each material only once. One
 * thread per scene. */
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
    const float (*normals)[3]; /* vertex normals; NULL: the triangles have none */
    size_t vertex_count;
    const uint32_t *corners; /* indices of the vertices, three per triangle */
    size_t corner_count;
    int material; /* index of the triangles' material; -1: none */
};

/* Creates an empty scene. `generator`: name of the program, which is written to the file. The caller frees it with glb_scene_destroy(). */
struct glb_scene *glb_scene_create(const char *generator);
/* Frees the scene and sets *scene to NULL. *scene may be NULL. */
void glb_scene_destroy(struct glb_scene **scene);

/* Returns the index of a matt, double-sided material with this linear colour and opacity; adds the material on the first call. */
int glb_scene_material(struct glb_scene *scene, const double rgba[4]);
/* Adds a mesh and returns its index. The mesh must have triangles before the scene is written. */
int glb_scene_add_mesh(struct glb_scene *scene, const char *name);
/* Adds triangles of one material to a mesh of the scene; copies the arrays. */
void glb_scene_add_triangles(struct glb_scene *scene, int mesh, const struct glb_scene_triangles *triangles);
/* Adds a node below the node `parent` (-1: as a root) and returns its index. mesh: index of its mesh; -1: none. matrix: column-major; NULL:
 * identity. */
int glb_scene_add_node(struct glb_scene *scene, int parent, const char *name, int mesh, const double matrix[16]);
/* Sets a property of a node; the file stores it in the node's `extras`. Text that is not UTF-8 is read as Latin-1, as names are. */
void glb_scene_set_property(struct glb_scene *scene, int node, const char *key, const char *value);

/* Writes the scene as a GLB file. Returns 0 or -errno (-EFBIG: larger than the 4 GiB limit of GLB). */
int glb_scene_write(struct glb_scene *scene, const char *path);

#ifdef __cplusplus
}
#endif
#endif
