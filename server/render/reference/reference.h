/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The second way to the field: worked out anew for each fragment, over all sensors, from the finest level's distances. Slow, and shares
   nothing with the usual way but what sensors say: it is what that is compared with (`--field per-fragment`).
   Thread: the one of the GL context. */
#ifndef RENDER_REFERENCE_H
#define RENDER_REFERENCE_H
#include "field/field.h"
#include "render/gl/draw_batches.h"
#include "render/gl/gpu_scene.h"

struct reference_model { /* of one asset file */
    GLuint corners, positions, distances, distance_texture;
};

struct reference {
    const struct gpu_scene *gpu_scene;
    struct field *field;
    struct reference_model *models; /* as gpu_scene->models; 0: not made yet */
};

void reference_init(struct reference *reference, const struct gpu_scene *gpu_scene, struct field *field);
void reference_finish(struct reference *reference); /* a zeroed one is fine */
/* The sensors of one asset as a shader reads them, as field_scalars with these parameters has just taken them. 0: out of memory. */
GLuint reference_sensors(const struct reference *reference, int asset, const struct field_params *params);
/* For the next draws of that asset. False: out of GPU memory, logged. */
bool reference_bind(struct reference *reference, int asset, GLuint sensors);
void reference_draw(const struct draw_command *commands, size_t count); /* the program in use is one that is made with PER_FRAGMENT */

#endif
