/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of the software renderer, and of one frame between its drawing steps. Private to soft/. */
#ifndef RENDER_SOFT_SOFT_IMPL_H
#define RENDER_SOFT_SOFT_IMPL_H
#include "render/soft/flags.h"
#include "render/soft/lanes.h"
#include "render/soft/soft.h"
#include "render/soft/parts.h"
#include "render/soft/pixel_lists.h"
#include "render/soft/textures.h"
#include "render/depth_grid.h"
#include "render/gl/frame_uniforms.h"
#include "render/shaded_colormap.h"
#include "render/soft/visibility_buffer.h"
#include "render/soft/visibility_store.h"

enum { BAND_ROWS = 32, RAMP_STEPS = MODEL_LIGHT_STEPS, SOFT_STRETCH_MOST = 64, SOFT_STRETCH_LEAST = 8 };

/* A mark is a 32-bit code, one per pixel, which is converted to the pixel's colour later. 0: no surface. Otherwise it holds an
   entry of the colour map, or a material and its light; the top bits tell which. */
/* mark (colour code) of a pixel that shows the field: MARK_FIELD | row * COLORMAP_COLUMNS + column of the colour map (bits of
   MARK_PLACE) | coverage by an isoline, 0..255 << MARK_LINE */
#define MARK_FIELD 0x40000000u
#define MARK_PLACE 0x1ffffu
enum { MARK_LINE = 17, MARK_LINE_WHOLE = 255 };
/* mark (colour code) of a pixel that shows an asset without a field: MARK_CONTEXT | row of the colour ramps << 16 (14 bits) |
   ambient light << 8 (8 bits) | sunlight (8 bits) */
#define MARK_CONTEXT 0x80000000u
/* marks (colour codes of pixels) of section cuts: MARK_CAP for the cap of a closed body; MARK_SECTION | encoded normal for the
   inner side of a surface (section_colors.h) */
#define MARK_SECTION 0xc0000000u
#define MARK_CAP 0xe0000000u
#define MARK_KIND 0xc0000000u
enum { MOST_RAMPS = 1 << 14 };
/* Mark of a field that is evaluated at the pixel. With i the index in raster->pixels: MARK_PIXELS | i << 8 | row of the colour
   map + raster->row_bias (8 bits). raster_color() evaluates the field and replaces the mark with MARK_FIELD | index of the
   colour in the rows of the colour map. */
#define MARK_PIXELS 0x20000000u

struct soft_vertex {
    float x, y, depth; /* x, y: pixels from the top left of the frame; depth: 1 near, 0 far */
    /* 1 / clip w; 0: the vertex is in front of the near plane, or beyond the guard band (a border around the frame, clip.h) */
    float inverse_w;
    /* a, b: if the vertex has a field: column of the colour map (logarithmic scale: the value) and row of the colour map; otherwise:
       ambient light and sunlight */
    float a, b;
    uint32_t flags; /* from soft_flags() */
};

struct soft_mesh { /* one asset in this frame */
    int asset;
    const struct asset_view *file;
    bool has_field;
    /* field values at the vertices; NULL: the asset has no field, or the field could not be computed and shows no data */
    const struct scalar *scalars;
    /* index in raster->pixels if the mesh's field is evaluated at each pixel; -1: the field is interpolated between vertices */
    int32_t pixels;
    const uint8_t (*baked)[4];
    /* matrix, column by column: from coordinates of the file to (x w, y w, z, w), with x and y in pixels and z, w of clip space */
    float place[4][4];
    uint32_t first_vertex, vertex_count;
    bool mirrored;
    bool cut;      /* true: section planes remove a part of the mesh, so the inner side of the rest is drawn */
    float turn[9]; /* matrix, column by column, that rotates normals from the file to the plant frame; set only for meshes that are cut */
};

struct soft_pixels { /* field of a mesh that is evaluated at pixels; positions are relative to the centre of the mesh */
    struct pixel_field field;     /* owned */
    struct pixel_list every;      /* list of all its sensors */
    uint32_t mesh;                /* index in raster->meshes */
    float place_from_pixel[4][4]; /* matrix, column by column */
};

struct soft_rect { /* rectangle in pixels, including the row `bottom` and the column `right` */
    int left, top, right, bottom;
};

struct soft_item { /* a part (group of neighbouring triangles, parts.h) that may be visible in the frame */
    float near;    /* depth of the part's nearest point; above 1: the part extends beyond the near plane towards the eye */
    struct soft_rect rect;
    uint32_t part;
    bool cut;    /* true: a section plane cuts through the part (group of triangles) */
    bool beyond; /* true: section planes remove the whole part; it is listed because it may bound a body that is cut open */
};

/* list of those parts (groups of triangles) of one mesh that may be visible; its memory is reused from frame to frame */
struct soft_found {
    const struct soft_parts *parts;
    uint32_t material; /* index, among the materials of all models, of the mesh's first material */
    bool both_sides;
    float eye_m[3]; /* eye position in the coordinates of the asset file, in metres */
    struct soft_rect rect;
    /* id of the first triangle of the first part in `items`. The ids of each part begin PART_TRIANGLES above those of the part
       before */
    uint32_t first_id;
    struct soft_item *items;
    size_t count, capacity;
};

struct soft_light {       /* copy, in main memory, of a light set (baked light) that is on the GPU */
    uint64_t id;          /* id of the light set (baked light) that was copied; 0: the entry is empty */
    uint8_t (**baked)[4]; /* baked light, indexed by asset and then by vertex */
    /* shadow map of the sun in square tiles. A tile takes two cache lines and is stored row by row, so that neighbouring texels
       mostly share cache lines */
    uint16_t *sun_map;
    uint32_t *sun_bounds; /* by tile of the shadow map: smallest texel | largest texel << 16 */
    int sun_map_px;       /* width and height of the shadow map on the GPU, in texels */
    int sun_tiles;        /* number of tiles of the shadow map in a row */
    /* brightness of the ground, 0..255 (255: no shadow). Each texel has four bytes: its own brightness and those of its right, lower and
       lower right neighbours */
    uint32_t *ground;
    uint8_t *open; /* openness of the ground to the sky, for refined frames; rows from the top */
    int ground_px; /* width and height, in texels, of the ground's light maps `ground` and `open` */
    uint64_t used;
};
/* Width of a tile of the shadow map. Lookups read a texel with its right and lower neighbours, so tiles overlap by one texel: a
   tile's last row and column are repeated as the first of the next tile. */
enum { SUN_TILE_PX = 8, SUN_TILE_STEP_PX = SUN_TILE_PX - 1, SUN_TILE_TEXELS = SUN_TILE_PX * SUN_TILE_PX };
static inline uint32_t soft_sun_bounds(const uint16_t texels[SUN_TILE_TEXELS])
{
    uint16_t least = UINT16_MAX, greatest = 0;
    for (int i = 0; i < SUN_TILE_TEXELS; i++) {
        least = texels[i] < least ? texels[i] : least;
        greatest = texels[i] > greatest ? texels[i] : greatest;
    }
    return least | (uint32_t)greatest << 16;
}
static inline size_t soft_sun_bounds_bytes(const struct soft_light *light)
{
    return (size_t)light->sun_tiles * (size_t)light->sun_tiles * sizeof(*light->sun_bounds);
}
static inline size_t soft_sun_map_bytes(const struct soft_light *light)
{
    return (size_t)light->sun_tiles * (size_t)light->sun_tiles * SUN_TILE_TEXELS * sizeof(*light->sun_map);
}
enum { SOFT_LIGHTS = 2, SOFT_SHAPES = 16 };

struct raster { /* all data of one frame's rasterization, input and pixels; its memory is reused for the next frame */
    struct soft *soft;
    const struct frame_context *context;
    const struct soft_light *light;
    const uint32_t *ramps;    /* table of colour ramps for this frame: muted_ramps or own_ramps of struct soft */
    const uint32_t *colormap; /* from struct shaded_colormap, or soft->glossy */
    const float *lines;
    struct frame_uniforms block;
    struct soft_mesh *meshes;
    struct soft_found *found; /* by mesh: list of its parts (groups of triangles) that may be visible */
    size_t found_capacity;
    size_t mesh_count, vertex_count;
    size_t mesh_capacity;
    struct soft_pixels *pixels;
    size_t pixels_count, pixels_capacity;
    /* A pixel whose field is still to be evaluated (MARK_PIXELS) stores its row of the colour map plus this number, so that the
       stored number is not negative. */
    int row_bias;
    int width_px, height_px, pitch_px; /* pitch_px: number of elements from one row to the next, a multiple of LANES */
    /* largest distance between a sample and its pixel's centre, along x or y, in pixels. Bounding rectangles are enlarged by
       it. 0 in previews, which sample the centre */
    float reach_px;
    float *depth;
    uint32_t *marks;
    /* by pixel: id of the triangle that it shows: first_id of the part + index in the part. Valid where the pixel's mark
       (colour code) is not 0; NULL: not needed */
    uint32_t *ids;
    size_t pixel_capacity;
    uint8_t *out;
    size_t out_stride_bytes;
    /* section planes as coefficients of (x w, y w, z, w), with x and y in pixels. The dot product is a point's signed distance
       from the plane, up to a factor; points with a negative distance are cut off. View rays enter the space that is kept
       through the first `entry_count` of the `cut_count` planes */
    float cuts[CLIP_MAX_PLANES][4];
    int cut_count, entry_count;
    float shift_px[2];  /* offset, from the pixel centres, of the samples being drawn, in pixels; 0 in previews */
    bool counts_bodies; /* true: the frame has section caps, which need a count of the closed bodies at each pixel (caps.c) */
    bool blends;        /* true: some of the parts (groups of triangles) found are blended (transparent) */
    bool has_ground;
    /* true: assets without a field are drawn grey (in views of values relative to alarm limits) */
    bool greys;
    float sun_from_pixel[4][4], ground_from_pixel[3][3], ray_from_pixel[3][3]; /* matrices, as columns */
    /* cells (squares of pixels) of the depth grid; finds_cells: true: raster_tiles() with SOFT_COLORS computes the cells, too */
    struct depth_cell *cells;
    size_t cell_capacity;
    bool finds_cells;
    struct depth_lens lens;
    /* length in pixels of the stretches over which the sky's elevation is interpolated: a power of two from SOFT_STRETCH_LEAST
       to SOFT_STRETCH_MOST. 1: the elevation is computed for each pixel */
    int stretch_px;
};

struct soft_kernels;
struct soft { /* shared by all frames */
    struct workers *workers;
    const struct soft_kernels *kernels;
    const struct gpu_scene *gpu_scene;
    const struct environments *environments;
    size_t material_count;       /* number of materials of all models together */
    uint32_t *material_of_model; /* by model: index, among all materials, of its first material */
    /* muted_ramps, own_ramps: tables with one colour ramp (RAMP_STEPS colours, from dark to bright) per row; ramp_of_material:
       [material]: row of its ramp in both tables */
    uint32_t *muted_ramps, *own_ramps, *ramp_of_material;
    struct soft_materials materials;
    lanes *shading;            /* by material: attributes of shading, at the indices BASE, METALLIC, ROUGHNESS, EMISSIVE (refined_impl.h) */
    const uint32_t *backdrops; /* from struct sky */
    struct soft_tones *tones;
    /* glossy colour map; its rows are brightness steps. glossy_version: version of the plain colour map used to make it */
    uint32_t *glossy;
    uint64_t glossy_version;
    struct soft_light lights[SOFT_LIGHTS];
    uint64_t uses;
    struct soft_parts **parts;                      /* parts (groups of triangles) by model, then by level; made when first needed */
    /* by tier (preview or refined): visibility buffers of views whose camera stands still */
    struct visibility_store kept[TIER_REFINED + 1];
    /* hashes (content_hash_shape()) of the last previews drawn; a repeated hash means that the camera has stopped moving */
    uint64_t shapes[SOFT_SHAPES];
    size_t shape_count;
    struct raster preview;
    /* memory that a finished refined frame left for reuse; NULL: none. Refined frames in progress own their memory */
    struct refined *spare;
};

/* Returns the copy, in main memory, of a light set (baked light); reads it from the GPU if needed. NULL: out of memory (logged). */
const struct soft_light *soft_get_light(struct soft *soft, const struct light_set *set);
void soft_free_light(const struct soft *soft, struct soft_light *light);
/* Returns the table of colours for pixels that show a field: colormap->texels or, if `glossy` is true, soft->glossy. */
const uint32_t *soft_colormap(struct soft *soft, const struct shaded_colormap *colormap, bool glossy);
void raster_finish(struct raster *raster); /* frees the raster's memory; the raster can be used again */
size_t raster_bytes(const struct raster *raster);
void refined_destroy(struct refined **refined); /* frees the refined frame and sets *refined to NULL; accepts a pointer to NULL */
size_t refined_bytes(const struct refined *refined);
void raster_copy_columns(const double from[16], float to[4][4]); /* copies a column-major matrix */
/* Steps of drawing a frame, declared in calling order. */
void raster_aim(struct raster *raster, const struct light *light); /* computes the matrices from pixels */
/* Prepares for the depth grid (coarse depth for clients, render/depth_grid.h), if the frame gets one; call it after raster_aim(). Without
   memory for the cells, the frame has no grid. */
void raster_aim_depth(struct raster *raster, const struct light *light);
/* Computes the depth grid's cells (squares of pixels) in a rectangle of the frame. The rectangle's top left corner must be the
   corner of a cell. Runs on a worker. */
void raster_find_cells(const struct raster *raster, const struct soft_rect *rect);
/* Makes the frame's depth grid (coarse depth for clients) from raster->cells; the caller owns it. NULL: the frame gets no grid, or memory
   ran out. */
struct depth_grid *raster_depth_grid(const struct raster *raster);
/* computes the section planes in pixel coordinates (raster->cuts); must be called before the other steps */
void raster_aim_cuts(struct raster *raster);
/* returns whether one of the first `planes` section planes cuts off the point `at`; at: (x w, y w, z, w), with x and y in pixels */
bool raster_is_cut_off(const struct raster *raster, const float at[4], int planes);
/* Tests a box in the mesh's coordinates against one section plane. Returns true if the box is cut away entirely; sets *cut to true if the
   plane cuts through the box. */
bool raster_cuts_box(const struct raster *raster, const struct soft_mesh *mesh, int plane, const float low[3], const float high[3],
                     bool *cut);
/* Returns the depth at which the ray through the point (x, y) of the frame enters the space that section planes leave uncut. 0:
   the ray never enters it, or the eye is already inside. */
float raster_entry_depth(const struct raster *raster, float x, float y);
/* Lists the meshes and parts (groups of triangles) that may be visible. bodies: also lists parts that bound closed bodies which a section
   plane cuts open. Returns false when out of memory. */
bool raster_find(struct raster *raster, bool bodies);
/* like raster_find(), but lists only the parts (groups of triangles) of one asset; their back faces are drawn, too */
bool raster_find_only(struct raster *raster, int asset);
/* like raster_find(), but lists only the parts (groups of triangles) of ghosted assets */
bool raster_find_ghosts(struct raster *raster);
/* draws the lines of ghosted assets into `veil` (rows of width_px): coverage of each pixel by a line, 0..255; overwrites the
   pixels' marks (colour codes). bgr: receives the lines' colour. Returns false when out of memory */
bool raster_ghosts(struct raster *raster, uint8_t *veil, uint8_t bgr[3]);
void raster_paint_ghosts(const struct raster *raster, const uint8_t *veil, const uint8_t bgr[3]);
/* output of raster_tiles() for each pixel: SOFT_CAPS: only marks (colour codes) of section caps; SOFT_DEPTH: all marks, and depth;
   SOFT_COLORS: marks, depth and colours */
enum soft_output { SOFT_CAPS, SOFT_DEPTH, SOFT_COLORS };
void raster_tiles(struct raster *raster, enum soft_output output);       /* rasterizes the found parts */
bool raster_make_room(struct raster *raster, const struct frame *frame); /* false: out of memory */
enum soft_rim { RIM_NONE, RIM_LIGHT, RIM_DARK };
/* finds the pixels that the outline of the selected asset covers; returns an enum soft_rim per pixel, rows pitch_px apart; overwrites
   raster->depth */
const uint8_t *raster_rim(const struct raster *raster);
/* Returns a visibility buffer for recolouring the frame. Call it while raster->ids is valid, and before edges, rims and markers
   are drawn. NULL: out of memory. */
struct visibility_buffer *raster_keep(struct raster *raster);
/* adds the outline of the selected asset to buffer->ink (lines drawn over pixels); overwrites raster->depth */
void raster_keep_rim(const struct raster *raster, struct visibility_buffer *buffer);
/* Stores the visibility buffer, with the frame's markers, in soft->kept, so that later frames of the same view only need new colours. */
void soft_keep(struct soft *soft, const struct frame_context *context, struct visibility_buffer *buffer, const struct frame *frame);
struct soft_triangle {
    uint32_t id; /* id of the triangle, as in struct soft_sample or raster->ids */
    uint32_t mesh, material;
    uint32_t vertices[3]; /* indices of the triangle's three vertices in the asset file */
};
/* Finds the triangle with this id among the found parts (groups of triangles). On entry, triangle->mesh is the index of the
   mesh to try first: the mesh of a neighbouring pixel, or 0. */
void raster_find_triangle(const struct raster *raster, uint32_t id, struct soft_triangle *triangle);
/* Computes the weights of the triangle's three corners at any point of the frame, up to a common factor. Weight i is
   weights[i][0] x + weights[i][1] y + weights[i][2]. vertices: indices in the asset file. */
void soft_weights(const struct soft_mesh *mesh, const uint32_t vertices[3], double weights[3][3]);
/* draws the outline of the selected asset, which covers the pixels with a mark (colour code); overwrites raster->depth */
void raster_outline(const struct raster *raster);

#endif
