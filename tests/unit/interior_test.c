/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which triangles lie inside a body: those that stand across a thin part do, unless visible triangles are connected only
   through them. */
#include "surface/repair/interior.h"

#include "tests/support/test.h"

/* A ring of four quadrangles, one or two of which stand across a thin part. One alone counts as interior, because the other
   three stay connected without it. Two opposite ones count as visible, because without them the others would fall into two
   pieces. */
TEST(what_alone_joins_is_seen)
{
    enum { AROUND = 4 };
    for (int across = 1; across <= 2; across++) {
        struct trimesh ring = { 0 };
        char hidden[2 * AROUND] = { 0 };
        for (int i = 0; i < 2 * AROUND; i++)
            trimesh_add_point(&ring, (const double[3]){ cos(i / 2 * M_PI / 2), sin(i / 2 * M_PI / 2), i % 2 });
        for (uint32_t i = 0; i < AROUND; i++) {
            uint32_t low = 2 * i, next = 2 * ((i + 1) % AROUND);
            trimesh_add_tri(&ring, low, next, low + 1, 0);
            trimesh_add_tri(&ring, next, next + 1, low + 1, 0);
        }
        for (int i = 0; i < across; i++)
            hidden[4 * i] = hidden[4 * i + 1] = INTERIOR_ACROSS;
        interior_resolve_across(&ring, hidden);
        for (int t = 0; t < 2 * AROUND; t++)
            assert_int_equal(hidden[t], across == 1 && t < 2 ? INTERIOR_INSIDE : INTERIOR_NOT);
        trimesh_finish(&ring);
    }
}
