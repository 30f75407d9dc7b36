/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uploads a model's materials and textures, and computes the colour ramps for previews. Call only in the thread that owns the GL
   context. */
#ifndef RENDER_GL_MATERIALS_H
#define RENDER_GL_MATERIALS_H
#include "render/gl/model.h"
#include "render/light/environments.h"

/* Uploads materials and textures of a model that model_init() made. up: the plant's up direction. Returns false when the GPU is out of
   memory. */
bool materials_upload(struct gl_model *model, struct gl *gl, const struct environment_light *sky, const double up[3]);
/* Deletes the GL textures and buffers that materials_upload() made; call before model_finish(). */
void materials_finish(struct gl_model *model);

#endif
