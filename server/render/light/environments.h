/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The environment maps of a plant on the GPU, by index. 0 is the built-in sky; 1 and up are those of the plant file, which
   workers read and convolve in the background. Call only in the thread that owns the GL context. */
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
    GLuint irradiance, mirrored; /* GL objects with the light in `of`: a uniform buffer and a 3D texture; 0: not loaded */
    struct environment_task *task;
};
struct environments {
    struct gl *gl;
    struct environment_slot slots[1 + PLANT_ENVIRONMENTS];
    int count;
    /* texels of the table that environment_brdf() computes, ENVIRONMENT_BRDF_PX wide and high; all renderers share the table */
    const float (*brdf_texels)[2];
    GLuint brdf; /* texture of brdf_texels */
};
enum { ENVIRONMENT_BRDF_PX = 48 };

struct environment_light { /* image-based light that shading code reads: the environment and the BRDF table (environment_brdf()) */
    const struct environment *of;
    const float (*brdf)[2];
};

/* Uploads the built-in sky and starts to load the plant's environments. plant and workers must outlive the environments. Logs
   and returns false when the GPU is out of memory. */
bool environments_init(struct environments *environments, struct gl *gl, const struct plant *plant, struct workers *workers);
void environments_finish(struct environments *environments);
/* Waits up to timeout_ns for an environment to load. Returns true once the environment's state is final: it is loaded, or its image cannot
   be read (logged), and the built-in sky is used instead. */
bool environments_wait(struct environments *environments, int number, int64_t timeout_ns);
/* Returns an environment's light, or the built-in sky's until the environment is loaded. Valid until environments_finish(). */
struct environment_light environments_get(const struct environments *environments, int number);
/* Binds an environment's uniform buffer and textures for all programs that include shaders/environment.glsl. */
void environments_bind(const struct environments *environments, int number);

#endif
