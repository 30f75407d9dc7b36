/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A rectangle of the picture while one thread draws it, part by part, nearest first. Private to soft/. */
#ifndef RENDER_SOFT_TILE_H
#define RENDER_SOFT_TILE_H
#include "render/soft/clip.h"
#include "render/soft/lanes.h"

enum { TILE_WIDTH_PX = 320, TILE_HEIGHT_PX = 184, BLOCK_SHIFT = 3, BLOCK_PX = 1 << BLOCK_SHIFT };
enum { BLOCK_COLUMNS = TILE_WIDTH_PX / BLOCK_PX, BLOCK_ROWS = TILE_HEIGHT_PX / BLOCK_PX };
enum { MOST_FACES = NEAR_TRIANGLES * PART_TRIANGLES, MOST_CORNERS = PART_VERTICES + NEAR_CORNERS * PART_TRIANGLES };

#define SOFT_LITTLE 1.02f /* from the nearest to the farthest: perspective is not seen */

struct soft_corners { /* vertices of a part, as struct soft_vertex, then those that cuts made */
    float x[MOST_CORNERS], y[MOST_CORNERS], depth[MOST_CORNERS], inverse_w[MOST_CORNERS], a[MOST_CORNERS], b[MOST_CORNERS];
    uint32_t flags[MOST_CORNERS]; /* of those that cuts made: SOFT_PATTERNS alone, and beside it */
    struct near_patterns cut_patterns[MOST_CORNERS - PART_VERTICES];
    int count, placed;  /* placed: that no cut made, the first ones */
    uint32_t all_flags; /* of any of them */
    bool flat;          /* no perspective to speak of */
    bool cut;           /* some are nearer than the near plane, or beyond the band */
};

struct soft_face { /* a triangle that faces the eye and covers a pixel's middle in the tile; its area as pixels go is over 0 */
    uint16_t corners[3];
    uint16_t triangle;                /* of the part; of a mesh that is cut also FACE_BACK */
    int16_t left, right, top, bottom; /* in the picture */
};

enum { FACE_BACK = 0x8000, FACE_TRIANGLE = PART_TRIANGLES - 1 }; /* the former: it looks away */

enum { MOST_SAMPLES = 4 };
struct soft_sample { /* of each pixel of a tile, row by row, from the tile's upper left one */
    float *depth;
    uint32_t *marks; /* NULL: not asked for; and below */
    uint32_t *ids;   /* first_id of the part + triangle of it | ID_BACK */
    float x, y;      /* so far from the pixel's middle */
};
#define ID_BACK 0x80000000u /* of a mesh that is cut: the triangle looks away */

struct soft_fragment { /* of what is blended, at a sample */
    uint32_t pixel;    /* in the samples' rows */
    uint32_t id, layer;
    float depth;
    uint8_t sample;
};

struct soft_fragments { /* zero-initialise; mem_free at */
    struct soft_fragment *at;
    size_t count, capacity;
};

struct soft_tile {
    const struct raster *raster;
    struct soft_rect rect; /* whole lanes wide */
    struct soft_sample samples[MOST_SAMPLES];
    int sample_count, pitch_px;                /* pitch: of their rows */
    float reach_px;                            /* samples lie no farther from a pixel's middle, along either axis */
    float farthest[BLOCK_ROWS][BLOCK_COLUMNS]; /* depth in each block: what lies behind it is hidden */
    struct soft_corners corners;
    struct soft_face faces[MOST_FACES];
    int face_count;
    uint32_t first_id; /* of the part's triangles, in raster->ids */
    int cuts;          /* planes that cut, of those of raster->cuts */
    enum { DRAW_ALL, DRAW_OPAQUE, DRAW_BLENDED } draws;
    struct soft_fragments *fragments; /* DRAW_BLENDED: what is drawn, instead of what is nearest */
    /* --- of the part being drawn */
    const struct soft_mesh *mesh;
    const struct soft_parts *parts;
    const struct soft_part *part;
    const struct soft_material *material;
};

static inline uint32_t soft_id(const struct soft_tile *tile, const struct soft_face *face)
{
    return (tile->first_id + (face->triangle & FACE_TRIANGLE)) | (face->triangle & FACE_BACK ? ID_BACK : 0);
}

/* Rasterizes what was found in a rectangle (whole lanes wide, no larger than a tile) into these samples, which hold the depth of what hides
   it already. Nothing but depth and ids is written; what is blended is added to the fragments, where nothing opaque hides it. On a
   worker. */
void raster_samples(const struct raster *raster, const struct soft_rect *rect, const struct soft_sample samples[MOST_SAMPLES], int pitch_px,
                    float reach_px, struct soft_fragments *fragments);

/* A triangle whose texture cuts holes. */
struct soft_cutout {
    const struct soft_material *material;
    const struct asset_view *file;
    uint32_t vertices[3];
    double weights[3][3];
};
void soft_cutout_init(struct soft_cutout *cutout, const struct soft_tile *tile, const struct soft_face *face);
bool soft_is_hole(const struct soft_cutout *cutout, float x, float y); /* a place in the picture */
/* column, row: in the picture. */
void soft_add_fragment(const struct soft_tile *tile, int sample, const struct soft_face *face, int column, int row, float depth);

/* The closed bodies that a part bounds, into the marks. */
void soft_count_part(struct soft_tile *tile, const struct soft_found *found, const struct soft_item *item);
void soft_cap_tile(struct soft_tile *tile); /* from these: marks and depth of what is cut open */
/* Marks the vertices of the tile's part that a section plane cuts off (inverse_w 0). */
void soft_cut_corners(struct soft_tile *tile);
/* The faces of a part out of corners that were placed, some of them to be cut off, and that carry. */
void soft_cut_faces(struct soft_tile *tile, bool both_sides);

#endif
