/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Materials and textures of a model: upload, and the ramps that the moving tier looks up. */
#ifndef RENDER_GL_MATERIALS_H
#define RENDER_GL_MATERIALS_H
#include "render/gl/model.h"

bool materials_upload(struct model *model, struct gl *gl, GLuint ramp_program); /* false: out of GPU memory, logged */
void materials_finish(struct model *model);

#endif
