/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reference computation of the field: at each fragment, from all sensors, with the distances of the finest level of detail. It
   is slow, and shares no code with the normal computation of fields; tests compare pictures with it (`--field per-fragment`).
   Call only in the thread that owns the GL context. */
#ifndef RENDER_REFERENCE_H
#define RENDER_REFERENCE_H
#include "field/field.h"
#include "render/gl/draw_batches.h"
#include "render/gl/gpu_scene.h"

struct reference_model { /* buffers of one asset file */
    GLuint corners, positions, distances, distance_texture;
};

struct reference {
    const struct gpu_scene *gpu_scene;
    struct field *field;
    /* by index in gpu_scene->models: GPU buffers with the distances of the model's vertices; 0: not made yet */
    struct reference_model *models;
};

void reference_init(struct reference *reference, const struct gpu_scene *gpu_scene, struct field *field);
void reference_finish(struct reference *reference); /* a zeroed struct is fine */
/* Uploads the sensors of one asset, with the readings used in the last call of field_scalars_of() with these parameters. The
   caller owns the buffer. Returns 0 when out of memory. */
GLuint reference_sensors(const struct reference *reference, int asset, const struct field_params *params);
/* Creates the GPU buffer that shaders with PIXEL_FIELD read to evaluate this field at each pixel. The caller owns the buffer.
   Logs and returns 0 when out of memory. */
GLuint reference_pixel_sensors(struct log *log, const struct pixel_field *field);
/* Binds the asset's distances and a buffer from reference_sensors() for the next draws of that asset. Logs and returns false
   when out of GPU memory. */
bool reference_bind(struct reference *reference, int asset, GLuint sensors);
/* issues the draw commands with a field value computed at each fragment; the current program must be compiled with PER_FRAGMENT */
void reference_draw(const struct draw_command *commands, size_t count);

#endif
