/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Closes hair gaps in the drawn mesh. Uses repair_join_points(), which also closes the gaps in the other mesh, on which
   distances along the surface are computed. */
#include "preprocess/geometry/gaps.h"

#include "base/math/gap_split.h"
#include "base/mem.h"
#include "surface/repair/repair.h"

#define SAME_M 1e-9 /* largest distance in metres between vertices that are treated as one position */

/* maximum number of passes over the mesh; one pass closes at most one gap at a corner where several gaps meet */
enum { MAX_ROUNDS = 4 };

static double widest_m(const float (*positions_m)[3], const uint32_t *indices, size_t index_count, double tolerance_m)
{
    double most_m = min_of(GAPS_MOST_M, GAPS_OF_SIZE * gap_main_size(positions_m, indices, index_count / 3));
    return tolerance_m > 0 ? min_of(most_m, tolerance_m) : most_m;
}

/* Moves the vertices of each mesh point p to the position of target[p], the point into which p was merged. */
static void move(float (*positions_m)[3], size_t vertex_count, const uint32_t *point_of, const struct trimesh *mesh, const uint32_t *target)
{
    for (size_t v = 0; v < vertex_count; v++)
        for (int axis = 0; axis < 3 && target[point_of[v]] != point_of[v]; axis++)
            positions_m[v][axis] = (float)mesh->points[target[point_of[v]]][axis];
}

/* Closes the hair gaps of a mesh in one pass. Returns the number of positions moved, or -1 if out of memory. */
static int64_t close_once(float (*positions_m)[3], size_t vertex_count, const uint32_t *indices, size_t index_count, double within_m,
                          uint32_t *point_of)
{
    struct trimesh mesh;
    struct repair_report report = { 0 };
    size_t degenerate, repeated;
    int64_t moved = -1;
    if (trimesh_weld(&mesh, &(struct trimesh_model){ (const float(*)[3])positions_m, vertex_count, indices, index_count / 3 }, SAME_M,
                     point_of, &degenerate, &repeated)) {
        uint32_t *target = mem_array(mesh.point_count, sizeof(*target));
        repair_join_points(&mesh, within_m, target, &report);
        moved = report.k < 0 ? -1 : 0;
        for (size_t p = 0; p < mesh.point_count && moved >= 0; p++)
            moved += target[p] != p;
        if (moved > 0)
            move(positions_m, vertex_count, point_of, &mesh, target);
        mem_free(target);
        mem_free(report.made);
    }
    trimesh_finish(&mesh);
    return moved;
}

bool gaps_close(float (*positions_m)[3], size_t vertex_count, const uint32_t *indices, size_t index_count, double tolerance_m,
                uint32_t *closed)
{
    uint32_t *point_of = mem_try_array(vertex_count, sizeof(*point_of));
    const double within_m = widest_m((const float(*)[3])positions_m, indices, index_count, tolerance_m);
    int64_t moved = point_of ? 1 : -1;
    for (int round = 0; round < MAX_ROUNDS && moved > 0; round++) {
        moved = close_once(positions_m, vertex_count, indices, index_count, within_m, point_of);
        *closed += moved > 0 ? (uint32_t)moved : 0;
    }
    mem_free(point_of);
    return moved >= 0;
}
