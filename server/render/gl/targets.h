/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A cache of free render targets (framebuffers), so that the next frame of the same size allocates no GPU memory. Call only in
   the thread that owns the GL context. */
#ifndef RENDER_GL_TARGETS_H
#define RENDER_GL_TARGETS_H
#include "gpu/target.h"

enum { TARGETS = 6 };
struct targets {               /* zero-initialise */
    struct target at[TARGETS]; /* render targets that no frame uses now, least recently used last; width 0: the element is empty */
    /* limit in bytes on the memory of free targets; one target is kept even if it exceeds the limit; 0: at most TARGETS
       targets, of any size */
    size_t bound_bytes;
};

/* Takes a render target of the given size from the cache, or creates one; the caller owns it until targets_give(). Logs and
   returns false when the GPU is out of memory. */
bool targets_take(struct targets *targets, struct log *log, int width_px, int height_px, int samples, struct target *out);
/* Puts a render target back into the cache; if the cache is full, the least recently used target is deleted. */
void targets_give(struct targets *targets, const struct target *target);
/* Returns the bytes of GPU memory that the free render targets (those that no frame uses) take. */
size_t targets_bytes(const struct targets *targets);
/* Sets the memory limit of the cache, and deletes free targets that exceed it. */
void targets_bound(struct targets *targets, size_t bytes);
/* Deletes all free targets. */
void targets_finish(struct targets *targets);

#endif
