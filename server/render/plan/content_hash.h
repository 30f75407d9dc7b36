/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a picture would show, as a number: equal for equal pictures. */
#ifndef RENDER_PLAN_CONTENT_HASH_H
#define RENDER_PLAN_CONTENT_HASH_H
#include "render/frame_context.h"

/* Of the view without its sequence numbers and times, and of every field in sight. */
uint64_t content_hash(const struct frame_context *context);
/* Of all that decides which triangle is at which pixel and in what light: equal for pictures that differ in values and colours only. */
uint64_t content_shape_hash(const struct frame_context *context);

#endif
