/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A tile: a rectangle of the frame into which one thread draws parts (groups of neighbouring triangles, parts.h), nearest first. Private to
   soft/. */
#ifndef RENDER_SOFT_TILE_H
#define RENDER_SOFT_TILE_H
#include "render/soft/clip.h"
#include "render/soft/lanes.h"

enum { TILE_WIDTH_PX = 320, TILE_HEIGHT_PX = 184, BLOCK_SHIFT = 3, BLOCK_PX = 1 << BLOCK_SHIFT };
enum { BLOCK_COLUMNS = TILE_WIDTH_PX / BLOCK_PX, BLOCK_ROWS = TILE_HEIGHT_PX / BLOCK_PX };
enum { MOST_FACES = NEAR_TRIANGLES * PART_TRIANGLES, MOST_CORNERS = PART_VERTICES + NEAR_CORNERS * PART_TRIANGLES };

/* perspective correction is omitted for faces whose largest corner depth is at most this many times the smallest, because the
   error would be negligible */
#define SOFT_LITTLE 1.02f

/* vertices of the part (group of triangles) that is being drawn, one array for each member of struct soft_vertex. After the
   part's own vertices come those that clipping added. */
struct soft_corners {
    float x[MOST_CORNERS], y[MOST_CORNERS], depth[MOST_CORNERS], inverse_w[MOST_CORNERS], a[MOST_CORNERS], b[MOST_CORNERS];
    /* Flags of the vertices. A vertex that clipping added has only the flags SOFT_PATTERNS, which say that it has patterns;
       cut_patterns has the strength of each pattern there. */
    uint32_t flags[MOST_CORNERS];
    struct near_patterns cut_patterns[MOST_CORNERS - PART_VERTICES];
    /* count: number of vertices; placed: number of the part's own vertices, which come before those that clipping added */
    int count, placed;
    uint32_t all_flags; /* the OR of all flags */
    bool flat;          /* perspective is negligible */
    /* true: some vertices are in front of the near plane or beyond the guard band (a border around the frame, clip.h), so faces
       must be clipped */
    bool cut;
};

struct soft_face { /* a triangle that faces the eye and covers a pixel centre of the tile; its area in pixels is positive */
    uint16_t corners[3];
    /* index of the triangle in the part (group of triangles); for meshes that a section plane cuts also the flag FACE_BACK */
    uint16_t triangle;
    int16_t left, right, top, bottom; /* in pixels of the frame */
};

/* bit of soft_face.triangle: FACE_BACK: the triangle faces away from the eye; FACE_TRIANGLE: bits of the index */
enum { FACE_BACK = 0x8000, FACE_TRIANGLE = PART_TRIANGLES - 1 };

enum { MOST_SAMPLES = 4 };
struct soft_sample { /* buffers with one sample for each pixel of a tile, row by row from the tile's upper left corner */
    float *depth;
    uint32_t *marks; /* mark (colour code, soft_impl.h) of each sample; NULL: not needed (`ids` may be NULL, too) */
    uint32_t *ids;   /* id of the triangle at each sample: first_id of the part + index in the part, and the flag ID_BACK */
    float x, y;      /* offset from the pixel's centre */
};
#define ID_BACK 0x80000000u /* flag of a triangle id, only for meshes that a section plane cuts: the triangle faces away from the eye */

struct soft_fragment { /* fragment: a blended (transparent) triangle at one sample of a pixel */
    uint32_t pixel;    /* index of the pixel in the sample arrays (soft_sample) of the tile */
    uint32_t id, layer;
    float depth;
    uint8_t sample;
};

struct soft_fragments { /* zero-initialise; free with mem_free(at) */
    struct soft_fragment *at;
    size_t count, capacity;
};

struct soft_tile {
    const struct raster *raster;
    struct soft_rect rect; /* rectangle of the tile; its width is a multiple of LANES */
    struct soft_sample samples[MOST_SAMPLES];
    int sample_count, pitch_px; /* number of samples per pixel; pitch_px: number of elements from one row of samples to the next */
    float reach_px;             /* largest offset of a sample from its pixel's centre, along x or y, in pixels */
    float farthest[BLOCK_ROWS][BLOCK_COLUMNS]; /* farthest depth in each block of 8 x 8 pixels; a surface entirely behind it is hidden */
    struct soft_corners corners;
    struct soft_face faces[MOST_FACES];
    int face_count;
    uint32_t first_id; /* id, in raster->ids, of the first triangle of the part (group of triangles) that is being drawn */
    int cuts;          /* number of section planes, from the first in raster->cuts, that clip the part (group of triangles) */
    enum { DRAW_ALL, DRAW_OPAQUE, DRAW_BLENDED } draws;
    /* list to which DRAW_BLENDED appends a fragment for each transparent triangle at each sample; in this mode neither depth nor ids are
       written */
    struct soft_fragments *fragments;
    /* --- the part (group of triangles) that is being drawn --- */
    const struct soft_mesh *mesh;
    const struct soft_parts *parts;
    const struct soft_part *part;
    const struct soft_material *material;
};

static inline uint32_t soft_id(const struct soft_tile *tile, const struct soft_face *face)
{
    return (tile->first_id + (face->triangle & FACE_TRIANGLE)) | (face->triangle & FACE_BACK ? ID_BACK : 0);
}

/* Rasterizes the parts (groups of triangles) found by raster_find() within a rectangle (a multiple of LANES wide, at most a
   tile). `samples` already hold the depth of nearer surfaces. Writes only depth and ids. Appends the fragments of blended
   triangles that no opaque surface hides to `fragments`. Runs on a worker. */
void raster_samples(const struct raster *raster, const struct soft_rect *rect, const struct soft_sample samples[MOST_SAMPLES], int pitch_px,
                    float reach_px, struct soft_fragments *fragments);

/* A triangle through whose holes surfaces behind are visible: its texture's alpha mask cuts the holes. */
struct soft_cutout {
    const struct soft_material *material;
    const struct asset_view *file;
    uint32_t vertices[3];
    double weights[3][3];
};
void soft_cutout_init(struct soft_cutout *cutout, const struct soft_tile *tile, const struct soft_face *face);
/* returns whether the texture has a hole at the point (x, y), in pixels from the upper left corner of the frame */
bool soft_is_hole(const struct soft_cutout *cutout, float x, float y);
/* Appends a fragment (a transparent triangle at one sample of a pixel) to tile->fragments. column, row: pixel of the frame. */
void soft_add_fragment(const struct soft_tile *tile, int sample, const struct soft_face *face, int column, int row, float depth);

/* Counts the closed bodies bounded by the triangles of a part (group of triangles): +1 where a ray leaves a body, -1 where it
   enters one. The counts replace the pixels' colour codes (marks). */
void soft_count_part(struct soft_tile *tile, const struct soft_found *found, const struct soft_item *item);
/* turns the counts of closed bodies that soft_count_part() left in raster->marks into section caps: their colour codes (marks) and depth */
void soft_cap_tile(struct soft_tile *tile);
/* Marks the vertices of the tile's current part (group of triangles) that a section plane cuts off, by setting their inverse_w to 0. */
void soft_cut_corners(struct soft_tile *tile);
/* Clips the faces of the tile's current part (group of triangles) and appends the resulting faces to the tile's list. The vertices must be
   projected and carry field and light. */
void soft_cut_faces(struct soft_tile *tile, bool both_sides);

#endif
