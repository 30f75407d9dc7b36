/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The geometry of one asset file on the GPU, shared by all its instances. Thread: the one of the GL context. */
#ifndef GPU_MESH_H
#define GPU_MESH_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <glad/gl.h>

#include "gpu/gl.h"

/* Vertex attributes, by the location that every shader uses. */
enum mesh_attribute { MESH_POSITION, MESH_NORMAL, MESH_TEXCOORD, MESH_COLOR, MESH_INSTANCE_NORMALS, MESH_SECOND_TEXCOORD = 7,
                      MESH_INSTANCE_PLACES };
enum { MESH_INSTANCE_VECTORS = 10 }; /* of 4 floats: 3 from the location of normals on, then 7 from that of places on */

/* Pointers need only live for the call, but for positions, colours and indices: GL on a processor reads them where they are
   (gl.reads_in_place), so they stay there, unchanged, until mesh_finish(). */
struct mesh_params {
    size_t vertex_count, index_count;
    const float (*positions_m)[3];
    const float (*normals)[3];
    const float (*texcoords)[2];        /* NULL: none */
    const float (*second_texcoords)[2]; /* NULL: none */
    const uint8_t (*colors)[4];         /* NULL: none */
    const uint32_t *indices;
};

/* Positions stay floats: light, picking, pictures without GL and faces that coincide with another asset's all rely on the same places.
   Normals are folded into 2 x 16 bits (shaders/normal.glsl), off by 0.005 degrees at most; texture coordinates are 2 x 16 bits where all
   lie in 0..1, off by 1/131,070. */
struct gpu_mesh {
    GLuint vao, instanced_vao, positions, normals, texcoords, second_texcoords, colors, indices;
    size_t vertex_count, index_count, bytes; /* bytes: of its own buffers; what is read in place is none of them */
    bool short_texcoords, short_second_texcoords;
};

bool mesh_init(struct gpu_mesh *mesh, const struct gl *gl, const char *name,
               const struct mesh_params *params); /* false: out of memory, logged */
void mesh_finish(struct gpu_mesh *mesh);
void mesh_bind(const struct gpu_mesh *mesh);                             /* for the next draws */
void mesh_bind_instances(const struct gpu_mesh *mesh, GLuint instances); /* a buffer of MESH_INSTANCE_VECTORS each, from its start */

/* An immutable buffer, or 0 when the GPU is out of memory (logged). */
GLuint mesh_buffer(struct log *log, const char *name, size_t bytes, const void *data, GLbitfield flags);

#endif
