/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One triangle against the near plane. */
#include "render/draft/draft_near.h"

struct near_corner near_corner_of(const struct draft_mesh *mesh, uint32_t vertex, float a, float b)
{
    const float *p = mesh->file->positions_m[vertex];
    struct near_corner corner = { .a = a, .b = b };
    for (int r = 0; r < 4; r++)
        corner.at[r] = mesh->place[0][r] * p[0] + mesh->place[1][r] * p[1] + mesh->place[2][r] * p[2] + mesh->place[3][r];
    return corner;
}

static struct near_corner between(const struct near_corner *from, const struct near_corner *to, float part)
{
    struct near_corner corner = { .a = from->a + part * (to->a - from->a), .b = from->b + part * (to->b - from->b) };
    for (int r = 0; r < 4; r++)
        corner.at[r] = from->at[r] + part * (to->at[r] - from->at[r]);
    return corner;
}

int near_cut(const struct near_corner at[3], struct near_corner out[4])
{
    int count = 0;
    for (int i = 0; i < 3; i++) {
        const struct near_corner *here = &at[i], *next = &at[(i + 1) % 3];
        float inside = here->at[3] - here->at[2], after = next->at[3] - next->at[2];
        if (inside >= 0)
            out[count++] = *here;
        if ((inside >= 0) != (after >= 0))
            out[count++] = between(here, next, inside / (inside - after));
    }
    return count >= 3 ? count : 0;
}
