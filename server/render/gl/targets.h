/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Targets by size, kept for the next picture of that size. Thread: the one of the GL context. */
#ifndef RENDER_GL_TARGETS_H
#define RENDER_GL_TARGETS_H
#include "gpu/target.h"

enum { TARGETS = 6 };
struct targets {               /* zero-initialise */
    struct target at[TARGETS]; /* least recently used last; width 0: empty */
    size_t bound_bytes;        /* one is kept in any case; 0: none but TARGETS */
};

/* The caller has it until targets_give. False: out of GPU memory, logged. */
bool targets_take(struct targets *targets, struct log *log, int width_px, int height_px, int samples, struct target *out);
void targets_give(struct targets *targets, const struct target *target);
size_t targets_bytes(const struct targets *targets);
void targets_bound(struct targets *targets, size_t bytes);
void targets_finish(struct targets *targets);

#endif
