/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The geometry of one asset file on the GPU, shared by all its instances. Call only in the thread that owns the GL context. */
#ifndef GPU_MESH_H
#define GPU_MESH_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <glad/gl.h>

#include "gpu/gl.h"

/* Locations of vertex attributes, the same in every shader. */
enum mesh_attribute {
    MESH_POSITION,
    MESH_NORMAL,
    MESH_TEXCOORD,
    MESH_COLOR,
    MESH_INSTANCE_NORMALS,
    MESH_SECOND_TEXCOORD = 7,
    MESH_INSTANCE_PLACES
};
/* number of 4-float vectors per instance: 3 rows of the normal matrix (from MESH_INSTANCE_NORMALS on), and 7 rows of position
   matrices (from MESH_INSTANCE_PLACES on) */
enum { MESH_INSTANCE_VECTORS = 10 };

/* Input of mesh_init(). Pointers need only be valid during the call, except for positions, colours and indices. If GL runs in
   software on the CPU (gl.reads_in_place), it reads these three arrays where they are, so they must stay unchanged until
   mesh_finish(). */
struct mesh_params {
    size_t vertex_count, index_count;
    const float (*positions_m)[3];
    const float (*normals)[3];
    const float (*texcoords)[2];        /* NULL: none */
    const float (*second_texcoords)[2]; /* NULL: none */
    const uint8_t (*colors)[4];         /* NULL: none */
    const uint32_t *indices;
};

/* Geometry on the GPU. Positions stay floats, because lighting, picking, software rendering and coincident faces rely on
   identical positions. Normals are packed into 2 x 16 bits (shaders/normal.glsl), with errors up to 0.005 degrees; texture
   coordinates into 2 x 16 bits if all are in 0..1, with errors up to 1/131,070. */
struct gpu_mesh {
    GLuint vao, instanced_vao, positions, normals, texcoords, second_texcoords, colors, indices;
    size_t vertex_count, index_count, bytes; /* bytes: size of the mesh's own GPU buffers, excluding data that GL reads in place */
    bool short_texcoords, short_second_texcoords;
};

bool mesh_init(struct gpu_mesh *mesh, const struct gl *gl, const char *name,
               const struct mesh_params *params); /* creates the buffers from `params`; returns false when out of memory (logged) */
void mesh_finish(struct gpu_mesh *mesh);
void mesh_bind(const struct gpu_mesh *mesh); /* binds the mesh's buffers, so that all following draw calls draw its geometry */
/* Sets the instances for the following draws. instances: a buffer of MESH_INSTANCE_VECTORS vectors per instance. */
void mesh_bind_instances(const struct gpu_mesh *mesh, GLuint instances);

/* Creates an immutable buffer. Returns its GL name; 0 when the GPU is out of memory (logged). */
GLuint mesh_buffer(struct log *log, const char *name, size_t bytes, const void *data, GLbitfield flags);

#endif
