/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws views of the scene. Thread: the one that made the GL context. */
#ifndef RENDER_RENDERER_H
#define RENDER_RENDERER_H
#include <stdbool.h>

#include "field/field.h"
#include "gpu/gl.h"
#include "render/frame.h"

struct renderer;

/* NULL on failure, logged. All must outlive it. */
struct renderer *renderer_create(struct log *log, struct gl *gl, const struct scene *scene, struct field *field);
void renderer_destroy(struct renderer **renderer);

/* What the picture of this view would show now; equal to frame->content of an earlier frame if drawing it again would give the
   same picture (camera, parameters, size and every field value in view, to a colour step). Brings the field up to date; cheap. */
uint64_t renderer_content(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot);
/* The caller owns the frame (frame_unref). NULL on failure, logged. view is already checked. */
struct frame *renderer_draw(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot);

#endif
