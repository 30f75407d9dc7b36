/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Triangles that the near plane cuts. Private to draft*.c. */
#ifndef RENDER_DRAFT_NEAR_H
#define RENDER_DRAFT_NEAR_H
#include "render/draft/draft_impl.h"

struct near_corner { /* in clip space, x and y in pixels; a and b as a vertex carries them */
    float at[4], a, b;
};

struct near_corner near_corner_of(const struct draft_mesh *mesh, uint32_t vertex, float a, float b);
/* What lies beyond the near plane. How many corners it has, in order: 0, 3 or 4. */
int near_cut(const struct near_corner at[3], struct near_corner out[4]);

#endif
