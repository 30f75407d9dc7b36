/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A picture before its field is coloured: for each pixel the triangle it shows, where on it, and how light it is there. While the
   camera stands still, changed readings need no more than looking colours up once more.
   Thread: the one of the GL context, but for what is said to be a worker's. */
#ifndef RENDER_SOFT_VISIBILITY_BUFFER_H
#define RENDER_SOFT_VISIBILITY_BUFFER_H
#include "base/workers.h"
#include "render/frame.h"
#include "render/frame_context.h"

/* What a pixel shows: a colour that no reading changes (blue | green << 8 | red << 16), several surfaces (their number in the band),
   or one triangle of the field (its number in the band). */
#define VISIBILITY_FIXED 0x80000000u
#define VISIBILITY_MIXED 0x40000000u

/* What is drawn over the colours. Up to VISIBILITY_INK: so much of a dark line; then the rim of what is selected. */
enum { VISIBILITY_INK = 253, VISIBILITY_RIM_DARK, VISIBILITY_RIM_LIGHT };

struct soft_tones;

struct visibility_gloss { /* of a glossy look, packed (tones.h): light that comes back of a white surface, and light besides */
    uint32_t of_color, besides;
};

struct visibility_part { /* of a pixel that shows several surfaces: one of the field */
    uint32_t triangle, weights;
    uint8_t row;
    uint16_t share; /* of VISIBILITY_SHARES */
};
enum { VISIBILITY_SHARES = 256, VISIBILITY_MOST_PARTS = 4 };

struct visibility_mixed {
    uint32_t blue_red, first_part; /* of what is fixed: blue and red times share, 16 bits each */
    uint16_t green;                /* likewise */
    uint16_t x, row;               /* in the band */
    uint8_t part_count;
};

/* How weights change over the picture: those of the second and the third corner are w1/sum and w2/sum, all three planes over it. */
struct visibility_slopes {
    float w1_x, w1_y, w2_x, w2_y, sum_x, sum_y, sum;
};

struct visibility_band {              /* of rows; written by one worker */
    uint32_t (*triangles)[3];         /* vertices of the picture; once it is settled, of what is kept */
    float (*corners)[4];              /* of what these carry now: the first corner's; by how much the second's is more, and the third's */
    struct visibility_slopes *slopes; /* likewise, where there are isolines */
    struct visibility_part *parts;
    struct visibility_gloss *gloss; /* by part, of glossy frames */
    struct visibility_mixed *mixed;
    size_t triangle_count, part_count, mixed_count;
    size_t triangle_capacity, corner_capacity, slope_capacity, part_capacity, gloss_capacity, mixed_capacity;
};

struct visibility_mesh { /* an asset with a field */
    int asset;
    uint32_t first_vertex, vertex_count; /* of the picture; once it is settled, of what is kept */
    bool read;                           /* what its vertices show now: */
    uint64_t content;                    /* of struct fields_entry */
};

struct visibility_buffer {
    int width_px, height_px, band_rows, band_count;
    uint32_t *surfaces;             /* per pixel, as above */
    uint32_t *weights;              /* of the triangle's second and third corner, 16 bits each */
    uint8_t *rows;                  /* of the colormap */
    struct visibility_gloss *gloss; /* NULL: rows say how light it is */
    const struct soft_tones *tones; /* with gloss; not owned */
    uint8_t *ink;                   /* once it is settled: not of what is fixed, which has it; and below */
    uint8_t *veil;                  /* so much of ghosts' lines, of 255. NULL: there are none */
    uint8_t veil_bgr[3];
    bool lined;   /* it can be drawn with isolines */
    float *depth; /* for their labels, rows of width_px. NULL: there are none */
    struct visibility_band *bands;
    struct visibility_mesh *meshes;
    size_t mesh_count, mesh_capacity, vertex_count;
    float scale[4];               /* of struct frame_uniforms, when the vertices were read */
    uint32_t *vertices;           /* those that are kept, by mesh: which of the asset's */
    float *carried;               /* per vertex: column of the colormap (on a logarithmic scale: the value); NAN: look at flags */
    float *plain;                 /* the same without NAN */
    uint32_t *flags;              /* as soft_flags */
    struct frame_marker *markers; /* places, and whether they are hidden */
    size_t marker_count;
};

struct visibility_buffer *visibility_buffer_create(int width_px, int height_px, int band_rows); /* NULL: out of memory */
/* Makes it one of a glossy frame. Returns false when out of memory. */
bool visibility_buffer_gloss(struct visibility_buffer *buffer, const struct soft_tones *tones);
void visibility_buffer_destroy(struct visibility_buffer **buffer); /* &NULL is fine; leaves NULL */
size_t visibility_buffer_bytes(const struct visibility_buffer *buffer);
/* The isolines of a picture. None: line_px is 0. */
struct resolve_lines {
    float line_px;
    const float *nearest; /* COLORMAP_PLACES: of shaded_colormap_create_lines */
};

/* On a worker: number of that triangle in the band. */
uint32_t visibility_add_triangle(struct visibility_band *band, const uint32_t vertices[3]);
void visibility_buffer_add_mesh(struct visibility_buffer *buffer, const struct visibility_mesh *mesh);
/* When all pixels are there, and what is drawn over them. Of vertices only those are kept that are seen. False: out of memory. */
bool visibility_buffer_settle(struct visibility_buffer *buffer, struct workers *workers);

/* The fields of the picture, into what vertices carry. */
void resolve_read(struct visibility_buffer *buffer, const struct frame_context *context, struct workers *workers);
/* On a worker, of the triangle that visibility_add_triangle gave last: weights of its corners over the picture, as planes, up to a
   factor. */
void visibility_add_slopes(struct visibility_band *band, const double weights[3][3]);
/* Colours of those bands. colormap: COLORMAP_ROWS x COLORMAP_COLUMNS, as it comes from the GPU. pattern_px: size of its cells. */
void resolve_colors(const struct visibility_buffer *buffer, const uint32_t *colormap, const struct resolve_lines *lines, float pattern_px,
                    struct workers *workers, int first, int count, struct frame *frame);

#endif
