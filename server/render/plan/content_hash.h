/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hashes of what a frame plan shows. Plans with equal hashes give equal frames. Pure. Call from any thread. */
#ifndef RENDER_PLAN_CONTENT_HASH_H
#define RENDER_PLAN_CONTENT_HASH_H
#include "render/plan/frame_plan.h"

/* Returns the hash of the plan's view and of the fields of its visible assets. Sequence numbers and the time of input are left out. */
uint64_t content_hash(const struct frame_plan *plan);
/* Returns the hash of everything that decides which triangle each pixel shows and in what light, and which sensors have markers.
   Frames that differ only in values and colours have the same hash. */
uint64_t content_hash_shape(const struct frame_plan *plan);

#endif
