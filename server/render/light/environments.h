/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The surroundings of a plant on the GPU, by number: 0 is the built-in sky, then those of the plant file, which the workers read and
   convolve meanwhile. Thread: the one of the GL context. */
#ifndef RENDER_ENVIRONMENTS_H
#define RENDER_ENVIRONMENTS_H
#include <stdint.h>

#include <glad/gl.h>

#include "base/workers.h"
#include "gpu/gl.h"
#include "plant/plant.h"

struct environment_slot {
    GLuint irradiance, mirrored; /* a uniform block, a 3D texture; 0: not there (yet) */
    struct environment_task *task;
};
struct environments {
    struct gl *gl;
    struct environment_slot slots[1 + PLANT_ENVIRONMENTS];
    int count;
    GLuint brdf;
};

/* Both must outlive it. False: out of GPU memory, logged. */
bool environments_init(struct environments *environments, struct gl *gl, const struct plant *plant, struct workers *workers);
void environments_finish(struct environments *environments);
/* Waits for at most that long. True: it will not change any more. One that cannot be read (logged) looks like the sky. */
bool environments_wait(struct environments *environments, int number, int64_t timeout_ns);
/* For all programs that include shaders/environment.glsl; the sky while it is not there. */
void environments_bind(const struct environments *environments, int number);

#endif
