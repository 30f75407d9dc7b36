/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The environment maps of a plant on the GPU, by number: 0 is the built-in sky, then those of the plant file, which workers read and
   convolve in the background. Thread: the one of the GL context. */
#ifndef RENDER_ENVIRONMENTS_H
#define RENDER_ENVIRONMENTS_H
#include <stdint.h>

#include <glad/gl.h>

#include "base/workers.h"
#include "gpu/gl.h"
#include "plant/plant.h"
#include "render/light/environment.h"

struct environment_slot {
    struct environment of;
    GLuint irradiance, mirrored; /* the same as a uniform buffer and a 3D texture; 0: not loaded (yet) */
    struct environment_task *task;
};
struct environments {
    struct gl *gl;
    struct environment_slot slots[1 + PLANT_ENVIRONMENTS];
    int count;
    const float (*brdf_texels)[2]; /* environment_brdf() of ENVIRONMENT_BRDF_PX; of all renderers */
    GLuint brdf;             /* texture of these */
};
enum { ENVIRONMENT_BRDF_PX = 48 };

struct environment_light { /* what surfaces are lit by */
    const struct environment *of;
    const float (*brdf)[2];
};

/* Uploads the sky and starts to load the others. plant and workers must outlive it. Returns false if the GPU is out of memory; that is
   logged. */
bool environments_init(struct environments *environments, struct gl *gl, const struct plant *plant, struct workers *workers);
void environments_finish(struct environments *environments);
/* Waits at most timeout_ns for one to load. Returns true if it is final: loaded, or unreadable, which is logged; then the sky is used. */
bool environments_wait(struct environments *environments, int number, int64_t timeout_ns);
/* Returns one; the sky as long as it is not loaded. Valid until the environments are finished. */
struct environment_light environments_get(const struct environments *environments, int number);
/* Binds that for all programs that include shaders/environment.glsl. */
void environments_bind(const struct environments *environments, int number);

#endif
