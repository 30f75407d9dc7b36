/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cracks in seams between faces: each crack is closed with the face across it, not with a face that overlaps it. */
#include "surface/repair/repair.h"

#include "tests/support/test.h"

#define GAP_M 0.0002f
#define TOLERANCE_M 0.001

/* BELOW: number of faces (quadrangles) of the lower sheet; the other four form a second sheet that lies on top of it */
enum { QUADS = 6, BELOW = 2 };

static size_t open_edges(const struct trimesh *mesh)
{
    size_t open = 0;
    for (size_t t = 0; t < mesh->tri_count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t a = mesh->tris[t][i], b = mesh->tris[t][(i + 1) % 3], faces = 0;
            for (size_t u = 0; u < mesh->tri_count; u++)
                for (int j = 0; j < 3; j++) {
                    uint32_t c = mesh->tris[u][j], d = mesh->tris[u][(j + 1) % 3];
                    faces += (a == c && b == d) || (a == d && b == c);
                }
            open += faces == 1;
        }
    return open;
}

/* Returns whether closing cracks has joined the two sheets: whether any vertex belongs to faces of both. */
static bool sheets_share(const struct trimesh *mesh)
{
    bool share = false;
    for (size_t t = 0; t < 3 * mesh->tri_count; t++)
        for (size_t u = 0; u < 3 * mesh->tri_count; u++)
            share = share || (mesh->tri_source[t / 3] < 2 * BELOW && mesh->tri_source[u / 3] >= 2 * BELOW &&
                              mesh->tris[t / 3][t % 3] == mesh->tris[u / 3][u % 3]);
    return share;
}

/* The lower sheet has a crack along y, with its left side at x = 0. In the upper sheet two cracks cross, and two of the four
   corners at the crossing touch the lower crack's left side. The repair must close each sheet's cracks without joining a point
   of one sheet to a point of the other. */
TEST(a_gap_is_not_set_into_one_that_it_runs_over)
{
    static const float corners[QUADS][8] = {
        { -2, -3, 0, -3, 0, 3, -2, 3 },                        /* below: left */
        { GAP_M, -3, 2, -3, 2, 3, GAP_M, 3 },                  /* right */
        { -1, -1, -0.5f, -1, 0, 0, -1, 0 },                    /* above: left, near */
        { -1, GAP_M, 0, GAP_M, 0.5f, 1, -1, 1 },               /* left, far */
        { -0.5f + GAP_M, -1, 1, -1, 1, 0, 2 * GAP_M, 0 },      /* right, near */
        { 2 * GAP_M, GAP_M, 1, GAP_M, 1, 1, 0.5f + GAP_M, 1 }, /* right, far */
    };
    float positions[4 * QUADS][3] = { { 0 } };
    uint32_t triangles[6 * QUADS], vertex_point[4 * QUADS], target[4 * QUADS];
    struct trimesh mesh = { 0 };
    struct repair_report report = { 0 };
    size_t degenerate = 0, repeated = 0;
    for (int i = 0; i < 4 * QUADS; i++)
        memcpy(positions[i], corners[i / 4] + 2 * (i % 4), 2 * sizeof(float));
    for (uint32_t i = 0; i < 6 * QUADS; i++)
        triangles[i] = 4 * (i / 6) + (const uint32_t[6]){ 0, 1, 2, 0, 2, 3 }[i % 6];
    assert_true(trimesh_weld(&mesh, &(struct trimesh_model){ (const float(*)[3])positions, 4 * QUADS, triangles, 2 * QUADS }, 1e-6,
                             vertex_point, &degenerate, &repeated));
    repair_seams(&mesh, TOLERANCE_M, target, &report);
    assert_false(sheets_share(&mesh));
    assert_int_equal(open_edges(&mesh), 6 + 8);
    mem_free(report.made);
    trimesh_finish(&mesh);
}

/* Two faces on both sides of a crack along x = 0, and two faces of the same shape exactly on top of them. Each must be joined
   with the face across the crack, not with the one that lies on it. */
TEST(a_gap_is_closed_across_not_with_what_lies_on_it)
{
    static const float corners[4][8] = {
        { -1, 0, 0, 0, 0, 1, -1, 1 },
        { GAP_M, 0, 1, 0, 1, 1, GAP_M, 1 },
        { -1, 0, 0, 0, 0, 1, -1, 1 },
        { GAP_M, 0, 1, 0, 1, 1, GAP_M, 1 },
    };
    float positions[16][3] = { { 0 } };
    uint32_t triangles[24], vertex_point[16], target[16];
    struct trimesh mesh = { 0 };
    struct repair_report report = { 0 };
    size_t degenerate = 0, repeated = 0;
    for (uint32_t q = 0; q < 4; q++) {
        static const uint32_t turned[2][6] = { { 0, 1, 2, 0, 2, 3 }, { 0, 1, 3, 1, 2, 3 } };
        for (int i = 0; i < 8; i++)
            positions[4 * q + (uint32_t)i / 2][i % 2] = corners[q][i];
        for (int i = 0; i < 4 && q >= 2; i++)
            /* the upper faces lie 5 micrometres higher: so close that they could be taken for an exact fit */
            positions[4 * q + (uint32_t)i][2] = (float)(0.005 * TOLERANCE_M);
        for (int i = 0; i < 6; i++)
            triangles[6 * q + (uint32_t)i] = 4 * q + turned[q / 2][i];
    }
    assert_true(trimesh_weld(&mesh, &(struct trimesh_model){ (const float(*)[3])positions, 16, triangles, 8 }, 1e-9, vertex_point,
                             &degenerate, &repeated));
    repair_seams(&mesh, TOLERANCE_M, target, &report);
    for (int i = 0; i < 2; i++) { /* the vertices at each end of the crack are merged */
        static const uint32_t ends[2][4] = { { 1, 4, 9, 12 }, { 2, 7, 10, 15 } };
        for (int j = 1; j < 4; j++)
            assert_int_equal(target[vertex_point[ends[i][j]]], target[vertex_point[ends[i][0]]]);
    }
    assert_int_equal(open_edges(&mesh), 0);
    mem_free(report.made);
    trimesh_finish(&mesh);
}
