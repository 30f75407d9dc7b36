/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Visibility buffer: for each pixel the triangle it shows, the position on the triangle and the light there. While the camera stands still,
   new readings only need their colours looked up again. Thread: the one of the GL context, except functions marked as running on a
   worker. */
#ifndef RENDER_SOFT_VISIBILITY_BUFFER_H
#define RENDER_SOFT_VISIBILITY_BUFFER_H
#include "base/workers.h"
#include "field/pixel_field.h"
#include "render/frame.h"
#include "render/frame_context.h"

/* surfaces[] of a pixel holds one of: VISIBILITY_FIXED | a colour that no reading changes (blue | green << 8 | red << 16); VISIBILITY_MIXED
   | index, in the band, of a pixel with several surfaces; or the index, in the band, of one triangle of the field. */
#define VISIBILITY_FIXED 0x80000000u
#define VISIBILITY_MIXED 0x40000000u

/* Ink of a pixel: lines drawn over its colour. 0 to VISIBILITY_INK: coverage by a dark line; above: dark or light rim of the selected
   asset. */
enum { VISIBILITY_INK = 253, VISIBILITY_RIM_DARK, VISIBILITY_RIM_LIGHT };

struct soft_tones;

/* glossy look, packed (tones.h): light reflected from a white surface, and light independent of the surface's colour */
struct visibility_gloss {
    uint32_t of_color, besides;
};

struct visibility_part { /* one surface of the field in a pixel with several surfaces */
    uint32_t triangle, weights;
    uint8_t row;
    uint16_t share; /* area of the pixel that the surface covers, 0..VISIBILITY_SHARES */
};
enum { VISIBILITY_SHARES = 256, VISIBILITY_MOST_PARTS = 4 };

struct visibility_mixed {
    /* blue_red: sum of the fixed colours times their shares, 16 bits each for blue and red; first_part: index of the first of its parts */
    uint32_t blue_red, first_part;
    uint16_t green;  /* the same sum for green */
    uint16_t x, row; /* position in the band */
    uint8_t part_count;
};

/* Planes over the frame that give the weights of a triangle's second and third corner: w1/sum and w2/sum. */
struct visibility_slopes {
    float w1_x, w1_y, w2_x, w2_y, sum_x, sum_y, sum;
};

struct visibility_place { /* a triangle: first corner, and vectors from it to the others; metres, in the asset file's frame */
    float first[3], second[3], third[3];
};

struct visibility_band { /* a band of rows; written by one worker */
    /* indices of vertices: among all of the frame, and after visibility_buffer_settle() among the kept (visible) ones */
    uint32_t (*triangles)[3];
    /* present values of each triangle: that of the first corner, and the differences of the second and third corner from it;
       fourth: 0, or 1 + the index of the mesh if its field is evaluated at pixels */
    float (*corners)[4];
    struct visibility_place *places; /* by triangle; only filled in where some field is evaluated at pixels */
    struct visibility_slopes *slopes; /* slopes of each triangle; only filled in where there are isolines */
    struct visibility_part *parts;
    struct visibility_gloss *gloss; /* per part, for glossy frames */
    struct visibility_mixed *mixed;
    size_t triangle_count, part_count, mixed_count;
    size_t place_count; /* triangles that have their place */
    size_t triangle_capacity, corner_capacity, place_capacity, slope_capacity, part_capacity, gloss_capacity, mixed_capacity;
};

struct visibility_mesh { /* an asset with a field */
    int asset;
    const struct asset_view *file;
    /* range of vertices: among all of the frame, and after visibility_buffer_settle() among the kept (visible) ones */
    uint32_t first_vertex, vertex_count;
    bool read;        /* true if `carried` has the values of the field version `content` */
    uint64_t content; /* hash from struct fields_entry */
    struct pixel_field pixels; /* from struct fields_entry */
};

struct visibility_buffer {
    int width_px, height_px, band_rows, band_count;
    uint32_t *surfaces;             /* per pixel, as described above */
    uint32_t *weights;              /* weights of the triangle's second and third corner, 16 bits each, for each pixel */
    uint8_t *rows;                  /* row of the colour map (brightness) for each pixel */
    struct visibility_gloss *gloss; /* light of glossy surfaces for each pixel; NULL: not glossy, brightness is in `rows` */
    const struct soft_tones *tones; /* set with gloss; not owned */
    uint8_t *ink;  /* ink of each pixel; visibility_buffer_settle() applies ink and veil to fixed colours and clears both there */
    uint8_t *veil; /* coverage by ghost lines, 0..255. NULL: there are no ghosts */
    uint8_t veil_bgr[3];
    bool lined;   /* slopes are stored, so isolines can be drawn */
    float *depth; /* depth for placing isoline labels, rows of width_px. NULL: there are none */
    struct visibility_band *bands;
    struct visibility_mesh *meshes;
    size_t mesh_count, mesh_capacity, vertex_count;
    bool evaluates;     /* some mesh's field is evaluated at pixels */
    float scale[4];     /* scale in struct frame_uniforms when the vertices were read */
    uint32_t *vertices; /* kept vertices, mesh by mesh: index in the asset's file */
    /* carried value of each kept vertex: column of the colour map (logarithmic scale: the value); NAN: it has a pattern's flag */
    float *carried;
    float *plain;                 /* the same without NAN */
    uint32_t *flags;              /* from soft_flags() */
    struct frame_marker *markers; /* positions of markers, and whether they are occluded */
    size_t marker_count;
};

struct visibility_buffer *visibility_buffer_create(int width_px, int height_px, int band_rows); /* NULL: out of memory */
/* Adds storage for the glossy look. Returns false when out of memory. */
bool visibility_buffer_gloss(struct visibility_buffer *buffer, const struct soft_tones *tones);
void visibility_buffer_destroy(struct visibility_buffer **buffer); /* &NULL is fine; sets it to NULL */
size_t visibility_buffer_bytes(const struct visibility_buffer *buffer);
/* Isolines of a frame. line_px 0: there are none. */
struct resolve_lines {
    float line_px;
    const float *nearest; /* COLORMAP_PLACES entries, from struct shaded_colormap */
};

/* Adds a triangle, unless it equals the last one. Returns its index in the band. Runs on a worker. */
uint32_t visibility_add_triangle(struct visibility_band *band, const uint32_t vertices[3]);
void visibility_buffer_add_mesh(struct visibility_buffer *buffer, const struct visibility_mesh *mesh);
/* Completes the buffer once all pixels and ink are set: drops vertices that no pixel shows and renumbers the others. Returns false when out
   of memory. */
bool visibility_buffer_settle(struct visibility_buffer *buffer, struct workers *workers);

/* Reads the fields of the frame into buffer->carried and the other values of the kept vertices. */
void resolve_read(struct visibility_buffer *buffer, const struct frame_context *context, struct workers *workers);
/* Stores the slopes of the triangle that visibility_add_triangle() added last. weights: planes of its corner weights, up to a factor. Runs
   on a worker. */
void visibility_add_slopes(struct visibility_band *band, const double weights[3][3]);
/* Colours `count` bands from `first` on. colormap: COLORMAP_ROWS x COLORMAP_COLUMNS texels. pattern_px: cell size of patterns. */
void resolve_colors(const struct visibility_buffer *buffer, const uint32_t *colormap, const struct resolve_lines *lines, float pattern_px,
                    struct workers *workers, int first, int count, struct frame *frame);

#endif
