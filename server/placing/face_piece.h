/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Faces (triangles of an asset's finest level of detail) and pieces of faces, for sums over the surface that need more points
   than the vertices. Call from any thread. */
#ifndef PLACING_FACE_PIECE_H
#define PLACING_FACE_PIECE_H
#include <string.h>

#include "base/math/vec.h"
#include "protocol/asset_format.h"

/* Returns the vertices of the faces, three for each; *count receives the number of faces. */
static inline const uint32_t (*face_list(const struct asset_view *view, size_t *count))[3]
{
    const struct asset_level *finest = &view->levels[0];
    const struct asset_primitive *first = &view->primitives[finest->first_primitive], *last = first + finest->primitive_count - 1;
    *count = finest->primitive_count > 0 ? (last->first_index + last->index_count - first->first_index) / 3 : 0;
    return (const uint32_t(*)[3])(view->indices + (*count > 0 ? first->first_index : 0));
}

/* Returns the area of a face in square metres. */
static inline double face_area(const struct asset_view *view, const uint32_t face[3])
{
    double normal[3];
    vecf_normal(view->positions_m[face[0]], view->positions_m[face[1]], view->positions_m[face[2]], normal);
    return vec_length(normal) / 2;
}

struct face_piece {      /* triangle within a face */
    float corners[3][3]; /* barycentric coordinates, in the face, of the piece's corners */
};
static const struct face_piece face_whole = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } };

/* Halves the piece at the midpoint of its side from corner `side` to the next corner. */
static inline void face_piece_halve(const struct face_piece *piece, int side, struct face_piece halves[2])
{
    float middle[3];
    int next = (side + 1) % 3;
    for (int c = 0; c < 3; c++)
        middle[c] = (piece->corners[side][c] + piece->corners[next][c]) / 2;
    halves[0] = halves[1] = *piece;
    memcpy(halves[0].corners[next], middle, sizeof(middle));
    memcpy(halves[1].corners[side], middle, sizeof(middle));
}

/* Writes the barycentric coordinates, in the face, of the piece's centroid. */
static inline void face_piece_middle(const struct face_piece *piece, float middle[3])
{
    for (int c = 0; c < 3; c++)
        middle[c] = (piece->corners[0][c] + piece->corners[1][c] + piece->corners[2][c]) / 3;
}

#endif
