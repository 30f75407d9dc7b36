/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a frame shows, as a number: equal for equal frames. Pure. Thread: any. */
#ifndef RENDER_PLAN_CONTENT_HASH_H
#define RENDER_PLAN_CONTENT_HASH_H
#include "render/plan/frame_plan.h"

/* Returns the hash of the view without its sequence numbers and times, and of every field in sight. */
uint64_t content_hash(const struct frame_plan *plan);
/* Returns the hash of all that decides which triangle is at which pixel and in what light: equal for frames that differ in values and
   colours only. */
uint64_t content_hash_shape(const struct frame_plan *plan);

#endif
