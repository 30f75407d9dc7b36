/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hashes of what a frame shows: equal for equal frames. Pure. Thread: any. */
#ifndef RENDER_PLAN_CONTENT_HASH_H
#define RENDER_PLAN_CONTENT_HASH_H
#include "render/plan/frame_plan.h"

/* Returns the hash of the view without its sequence numbers and times, and of all visible fields. */
uint64_t content_hash(const struct frame_plan *plan);
/* Returns the hash of everything that decides which triangle each pixel shows and in what light: equal for frames that differ only in
   values and colours. */
uint64_t content_hash_shape(const struct frame_plan *plan);

#endif
