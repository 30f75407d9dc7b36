/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Visibility buffer: for each pixel the triangle it shows, the position on the triangle and the light there. While the camera
   stands still, a frame with new readings is made from the buffer by looking up colours again. Call only in the thread that
   owns the GL context, except functions marked as running on a worker. */
#ifndef RENDER_SOFT_VISIBILITY_BUFFER_H
#define RENDER_SOFT_VISIBILITY_BUFFER_H
#include "base/workers.h"
#include "render/frame.h"
#include "render/frame_context.h"
#include "render/soft/pixel_lists.h"

/* Values of surfaces[], by pixel. VISIBILITY_FIXED | a colour that no reading changes (blue | green << 8 | red << 16).
   VISIBILITY_MIXED | index of a struct visibility_mixed in the band (group of pixel rows). Without a flag, the pixel shows a
   field, and the value is the index of its triangle in the band. */
#define VISIBILITY_FIXED 0x80000000u
#define VISIBILITY_MIXED 0x40000000u

/* Ink of a pixel: lines drawn over its colour. 0 to VISIBILITY_INK: coverage by a dark line; VISIBILITY_RIM_DARK, VISIBILITY_RIM_LIGHT: the
   rim of the selected asset. */
enum { VISIBILITY_INK = 253, VISIBILITY_RIM_DARK, VISIBILITY_RIM_LIGHT };

struct soft_tones;

/* Light that a pixel reflects in the glossy look, packed (tones.h). besides: light that a black surface would reflect; of_color: additional
   light that a white surface would reflect. */
struct visibility_gloss {
    uint32_t of_color, besides;
};

struct visibility_part { /* surface with a field, in a pixel that shows several surfaces */
    uint32_t triangle, weights;
    uint8_t row;
    uint16_t share; /* area of the pixel that the surface covers, 0..VISIBILITY_SHARES */
};
enum { VISIBILITY_SHARES = 256, VISIBILITY_MOST_PARTS = 4 };

struct visibility_mixed {
    /* blue_red: sum of the colours that no reading changes, each weighted by the area it covers, 16 bits each for blue and red.
       first_part: index of the pixel's first surface with a field among the `parts` of the band */
    uint32_t blue_red, first_part;
    uint16_t green;  /* the same sum for green */
    uint16_t x, row; /* position in the band */
    uint8_t part_count;
};

/* Corner weights of a triangle at a point (x, y) of the frame: p1 / s for the second corner and p2 / s for the third. p1, p2
   and s are linear in x and y. w1_x, w1_y: slopes of p1; w2_x, w2_y: slopes of p2; s = sum_x x + sum_y y + sum. */
struct visibility_slopes {
    float w1_x, w1_y, w2_x, w2_y, sum_x, sum_y, sum;
};

/* position of a triangle in the asset file's frame, in metres: its first corner, and the vectors from there to the second and third */
struct visibility_place {
    float first[3], second[3], third[3];
};

struct visibility_band { /* a band: group of pixel rows; written by one worker */
    /* indices of the triangles' corners: at first among all vertices of the frame; visibility_buffer_settle() changes them to indices among
       the visible vertices */
    uint32_t (*triangles)[3];
    /* by triangle: [0] field value at the first corner; [1] and [2] how much the values at the second and third corner exceed
       it; [3] 0, or, if the mesh's field is evaluated at pixels, 1 + index of the mesh */
    float (*corners)[4];
    struct visibility_place *places; /* corner position and edges of each triangle; only filled in if a field is evaluated at pixels */
    /* by triangle: slopes of the corner weights over the frame; only filled in where there are isolines */
    struct visibility_slopes *slopes;
    struct visibility_part *parts;
    struct visibility_gloss *gloss; /* light on each surface in `parts`; only filled in for the glossy look */
    struct visibility_mixed *mixed;
    struct pixel_cell *cells; /* cells that show fields of many sensors (pixel_lists.h), sorted by square, then by mesh */
    size_t triangle_count, part_count, mixed_count;
    size_t place_count; /* number of elements of `places` */
    size_t cell_count, cell_capacity;
    size_t triangle_capacity, corner_capacity, place_capacity, slope_capacity, part_capacity, gloss_capacity, mixed_capacity;
};

struct visibility_mesh { /* an asset with a field */
    int asset;
    const struct asset_view *file;
    /* range of the mesh's vertices: at first indices among all vertices of the frame; after visibility_buffer_settle() among the visible
       ones */
    uint32_t first_vertex, vertex_count;
    /* true: buffer->carried holds this mesh's field values, in the version that the hash `content` identifies */
    bool read;
    uint64_t content;          /* hash from struct fields_entry */
    struct pixel_field pixels; /* copy from struct fields_entry, owned */
    struct pixel_list every;   /* all sensors of `pixels` */
};

struct visibility_buffer {
    int width_px, height_px, band_rows, band_count;
    uint32_t *surfaces;             /* per pixel, as described above */
    uint32_t *weights;              /* by pixel: weights of two corners of its triangle, 16 bits each: second corner | third corner << 16 */
    uint8_t *rows;                  /* by pixel: row of the shaded colour map, that is, the brightness of the surface */
    /* [pixel]: light that the pixel reflects in the glossy look. NULL: the frame has another look, and `rows` has the
       brightness of surfaces */
    struct visibility_gloss *gloss;
    const struct soft_tones *tones; /* set with gloss; not owned */
    /* Ink of each pixel (line drawn over its colour, VISIBILITY_INK). In pixels whose colour no reading changes,
       visibility_buffer_settle() draws ink and veil (lines of ghosted assets) into the colour itself, and sets both to 0. */
    uint8_t *ink;
    uint8_t *veil; /* by pixel: coverage by ghost lines, 0..255; NULL: there are no ghosts */
    uint8_t veil_bgr[3];
    bool lined;   /* true: `slopes` of all bands (groups of pixel rows) are stored, because the frame has isolines */
    float *depth; /* depth of each pixel, for placing isoline labels; rows of width_px; NULL: not stored */
    struct visibility_band *bands;
    struct visibility_mesh *meshes;
    size_t mesh_count, mesh_capacity, vertex_count;
    bool evaluates; /* true: the field of at least one mesh is evaluated at pixels */
    /* true: resolve_read() must find the cells (squares of pixels with fields of many sensors) again, because the set of such
       meshes has changed */
    bool finds_cells;
    /* frame_uniforms.scale (MIN, range and logarithm of the colour scale) used to compute the values in `carried` */
    float scale[4];
    uint32_t *vertices; /* visible vertices, mesh by mesh: index of each in the asset's file */
    /* value at each visible vertex, interpolated over triangles: column of the colour map or, on a logarithmic scale, the
       field's value. NAN: a flag of the vertex selects a pattern */
    float *carried;
    /* like `carried`, but with the field's value also at vertices where `carried` is NAN because a pattern is shown */
    float *plain;
    uint32_t *flags;              /* from soft_flags() */
    struct depth_grid *grid;      /* reference to the frame's depth grid (coarse depth for clients); NULL: the frame has none */
    struct frame_marker *markers; /* positions of markers in the frame, and whether surfaces hide them */
    size_t marker_count;
};

struct visibility_buffer *visibility_buffer_create(int width_px, int height_px, int band_rows); /* NULL: out of memory */
/* Allocates buffer->gloss, which the glossy look needs. Returns false when out of memory. */
bool visibility_buffer_gloss(struct visibility_buffer *buffer, const struct soft_tones *tones);
/* frees the buffer and sets *buffer to NULL; accepts a pointer to NULL */
void visibility_buffer_destroy(struct visibility_buffer **buffer);
size_t visibility_buffer_bytes(const struct visibility_buffer *buffer);
struct resolve_paint {        /* colours, patterns and isolines used to colour a visibility buffer */
    const uint32_t *colormap; /* COLORMAP_ROWS x COLORMAP_COLUMNS texels */
    float pattern_px;         /* cell size of patterns */
    float line_px;            /* width of isolines in pixels; 0: the frame has no isolines */
    const float *nearest;     /* table of struct shaded_colormap: by position on the scale, the nearest position that has an isoline */
};

/* Adds a triangle to the list of the band (group of pixel rows), unless it equals the triangle added last. Returns its index in the list.
   Runs on a worker. */
uint32_t visibility_add_triangle(struct visibility_band *band, const uint32_t vertices[3]);
void visibility_buffer_add_mesh(struct visibility_buffer *buffer, const struct visibility_mesh *mesh);
/* Completes the buffer once all pixels and ink (lines drawn over pixels) are set: drops vertices that no pixel shows and renumbers the
   others. Returns false when out of memory. */
bool visibility_buffer_settle(struct visibility_buffer *buffer, struct workers *workers);

/* Copies the field values of the frame's assets into buffer->carried, plain and flags, for all visible vertices. */
void resolve_read(struct visibility_buffer *buffer, const struct frame_context *context, struct workers *workers);
/* Stores the slopes of the triangle that visibility_add_triangle() added last. weights: from soft_weights(). Runs on a worker. */
void visibility_add_slopes(struct visibility_band *band, const double weights[3][3]);
/* Bands (groups of pixel rows) to colour from band `first` on; argument of color_bands in kernels.h. */
struct resolve_job {
    const struct visibility_buffer *buffer;
    struct resolve_paint paint;
    size_t first;
    struct frame *frame;
};

#endif
