/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Large triangles of one asset, whose light is looked up within them too: a vertex in a corner of the plant would darken all of them.
   What is found goes to their corners, by how near each is (the right-hand side of Kavan, Bargteil and Sloan, "Least squares vertex
   baking", 2011, with its matrix lumped). Private to bake.c. Thread: the one of the GL context. */
#ifndef RENDER_BAKE_FACES_H
#define RENDER_BAKE_FACES_H
#include "render/gl/gpu_scene.h"

enum { BAKE_FACE_SAMPLES = 6 }; /* in each; as in shaders/bake.comp */

struct bake_faces {
    size_t count;
    GLuint corners; /* three vertices each */
    GLuint sums;    /* of each vertex: weight, openness, sun; in 256ths */
};

/* Those of the finest level with an edge of at least that length. False: out of GPU memory, logged; there are none then. */
bool bake_faces_init(struct bake_faces *faces, const struct gpu_scene *gpu_scene, size_t asset, double least_m);
void bake_faces_finish(struct bake_faces *faces); /* leaves none */

#endif
