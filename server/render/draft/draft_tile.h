/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A rectangle of the picture while one thread draws it, part by part, nearest first. Private to draft*.c. */
#ifndef RENDER_DRAFT_TILE_H
#define RENDER_DRAFT_TILE_H
#include "render/draft/draft_near.h"
#include "render/draft/draft_simd.h"

enum { TILE_WIDTH_PX = 320, TILE_HEIGHT_PX = 184, BLOCK_SHIFT = 3, BLOCK_PX = 1 << BLOCK_SHIFT };
enum { BLOCK_COLUMNS = TILE_WIDTH_PX / BLOCK_PX, BLOCK_ROWS = TILE_HEIGHT_PX / BLOCK_PX };
enum { MOST_FACES = NEAR_TRIANGLES * PART_TRIANGLES, MOST_CORNERS = PART_VERTICES + NEAR_CORNERS * PART_TRIANGLES };

#define DRAFT_LITTLE 1.02f /* from the nearest to the farthest: perspective is not seen */

struct draft_corners { /* vertices of a part, as struct draft_vertex, then those that cuts made */
    float x[MOST_CORNERS], y[MOST_CORNERS], depth[MOST_CORNERS], inverse_w[MOST_CORNERS], a[MOST_CORNERS], b[MOST_CORNERS];
    uint32_t flags[MOST_CORNERS]; /* of those that cuts made: DRAFT_PATTERNS alone, and beside it */
    struct near_patterns cut_patterns[MOST_CORNERS - PART_VERTICES];
    int count, placed; /* placed: that no cut made, the first ones */
    uint32_t all_flags; /* of any of them */
    bool flat;          /* no perspective to speak of */
    bool cut;           /* some are nearer than the near plane, or beyond the band */
};

struct draft_face { /* a triangle that faces the eye and covers a pixel's middle in the tile; its area as pixels go is over 0 */
    uint16_t corners[3];
    uint16_t triangle;                /* of the part; of a mesh that is cut also FACE_BACK */
    int16_t left, right, top, bottom; /* in the picture */
};

enum { FACE_BACK = 0x8000, FACE_TRIANGLE = PART_TRIANGLES - 1 }; /* the former: it looks away */

struct draft_tile {
    const struct draft *draft;
    struct draft_rect rect; /* whole lanes wide */
    float farthest[BLOCK_ROWS][BLOCK_COLUMNS]; /* depth in each block: what lies behind it is hidden */
    struct draft_corners corners;
    struct draft_face faces[MOST_FACES];
    int face_count;
    uint32_t first_id; /* of the part's triangles, in draft->ids */
    int cuts;          /* planes that cut, of those of draft->cuts */
    /* --- of the part being drawn */
    const struct draft_mesh *mesh;
    const struct draft_parts *parts;
    const struct draft_part *part;
};

/* The closed bodies that a part bounds, into the marks. */
void draft_count_part(struct draft_tile *tile, const struct draft_found *found, const struct draft_item *item);
void draft_cap_tile(struct draft_tile *tile); /* from these: marks and depth of what is cut open */
/* Vertices of a part that lie beyond a plane that cuts are to be cut off. */
void draft_cut_corners(struct draft_tile *tile);
/* The faces of a part out of corners that were placed, some of them to be cut off, and that carry. */
void draft_cut_faces(struct draft_tile *tile, bool both_sides);

#endif
