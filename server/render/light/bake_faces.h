/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Large triangles of one asset. Light is also sampled inside them, since otherwise one vertex in a dark corner would darken the
   whole triangle. A sample's light is distributed to the triangle's corners by barycentric weight. This is the right-hand side
   of Kavan, Bargteil and Sloan, "Least squares vertex baking" (2011), with a lumped matrix. Private to bake.c. Call only in the
   thread that owns the GL context. */
#ifndef RENDER_BAKE_FACES_H
#define RENDER_BAKE_FACES_H
#include "render/gl/gpu_scene.h"

enum { BAKE_FACE_SAMPLES = 6 }; /* number of light samples per large triangle; must match shaders/bake.comp */

struct bake_faces {
    size_t count;
    GLuint corners; /* GL buffer with the vertex indices of the large triangles, three each */
    GLuint sums;    /* GL buffer with three sums per vertex over the light samples: weight, openness and visible sun, in units of 1/256 */
};

/* Finds the triangles of an asset's finest level of detail that have an edge of at least least_m metres. Returns false when the
   GPU is out of memory (logged); `count` is 0 then. */
bool bake_faces_init(struct bake_faces *faces, const struct gpu_scene *gpu_scene, size_t asset, double least_m);
/* Deletes the GL buffers of `faces` and sets its count to 0. */
void bake_faces_finish(struct bake_faces *faces);

#endif
