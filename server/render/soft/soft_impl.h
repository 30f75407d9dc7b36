/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the steps of a preview hand to each other. Private to soft/. */
#ifndef RENDER_SOFT_SOFT_IMPL_H
#define RENDER_SOFT_SOFT_IMPL_H
#include "render/soft/flags.h"
#include "render/soft/lanes.h"
#include "render/soft/soft.h"
#include "render/soft/parts.h"
#include "render/soft/textures.h"
#include "render/gl/frame_uniforms.h"
#include "render/shaded_colormap.h"
#include "render/soft/visibility_buffer.h"
#include "render/soft/visibility_store.h"

enum { BAND_ROWS = 32, RAMP_STEPS = MODEL_LIGHT_STEPS, SOFT_STRETCH_MOST = 64, SOFT_STRETCH_LEAST = 8 };

/* Marks of pixels. 0: nothing. Else a colour of the colormap, or a material and the light on it, to be looked up. */
#define MARK_FIELD 0x40000000u /* | colormap row * COLORMAP_COLUMNS + column (MARK_PLACE) | so much of an isoline << MARK_LINE (8 bits) */
#define MARK_PLACE 0x1ffffu
enum { MARK_LINE = 17, MARK_LINE_WHOLE = 255 };
#define MARK_CONTEXT 0x80000000u /* | ambient << 8 (8 bits) | sun (8 bits) | row of the ramps << 16 (14 bits) */
#define MARK_SECTION 0xc0000000u /* what a cut opens: MARK_CAP, or the inner side of a surface | its normal (section_colors.h) */
#define MARK_CAP 0xe0000000u
#define MARK_KIND 0xc0000000u
enum { MOST_RAMPS = 1 << 14 };

struct soft_vertex {
    float x, y, depth; /* pixels from the top left; 1 near, 0 far */
    float inverse_w;   /* 0: nearer than the near plane, or beyond the band (clip.h) */
    float a, b;        /* field: column and row of the colormap (logarithmic: value and row); context: ambient, facing the sun */
    uint32_t flags;    /* soft_flags */
};

struct soft_mesh { /* one asset in this picture */
    int asset;
    const struct asset_view *file;
    bool has_field;
    const struct scalar *scalars; /* NULL: context, or a field that could not be worked out: no data */
    const uint8_t (*baked)[4];
    float place[4][4]; /* columns; x w, y w in pixels, z and w of clip space */
    uint32_t first_vertex, vertex_count;
    bool mirrored;
    bool cut;      /* something of it is cut away: what is left shows its inner side */
    float turn[9]; /* of one that is cut: columns, plant from file, for normals */
};

struct soft_rect { /* pixels, the last ones included */
    int left, top, right, bottom;
};

struct soft_item { /* a part that may be seen */
    float near;    /* depth; over 1: some of it is nearer than the near plane */
    struct soft_rect rect;
    uint32_t part;
    bool cut;    /* it lies on both sides of a plane that cuts */
    bool beyond; /* nothing of it is left; it may bound a body that is cut open before it */
};

struct soft_found { /* what of one mesh may be seen; kept from picture to picture */
    const struct soft_parts *parts;
    uint32_t material; /* its first */
    bool both_sides;
    float eye_m[3]; /* in the frame of its file */
    struct soft_rect rect;
    uint32_t first_id; /* PART_TRIANGLES for each item */
    struct soft_item *items;
    size_t count, capacity;
};

struct soft_light {       /* a light_set, read back */
    uint64_t id;          /* of the set; 0: empty */
    uint8_t (**baked)[4]; /* by asset */
    uint16_t *sun_map;    /* in square tiles of two cache lines, row by row as what is in them: neighbours lie together */
    uint32_t *sun_bounds; /* of each tile: the least of its texels | the greatest << 16 */
    int sun_map_px;       /* of a side, as it was on the GPU */
    int sun_tiles;        /* in a row of tiles */
    uint32_t *ground; /* a byte each: this texel, its right, lower, lower right neighbour; 255: no shadow */
    uint8_t *open;    /* of the ground, which refined frames look up; rows from the top */
    int ground_px;    /* of a side, of both */
    uint64_t used;
};
/* A texel is looked up with its right and lower neighbours, so its tile has these: its last row and column are the next ones' first. */
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

struct raster { /* what one frame is rasterized from, and into; its room is kept for the next one */
    struct soft *soft;
    const struct frame_context *context;
    const struct soft_light *light;
    const uint32_t *ramps;    /* of struct soft */
    const uint32_t *colormap; /* and below: struct shaded_colormap, or glossy */
    const float *lines;
    struct frame_uniforms block;
    struct soft_mesh *meshes;
    struct soft_found *found; /* by mesh */
    size_t found_capacity;
    size_t mesh_count, vertex_count;
    size_t mesh_capacity;
    int width_px, height_px, pitch_px; /* pitch: a multiple of LANES */
    float reach_px;                    /* of parts that are found: so far from a pixel's middle it is looked at; previews: 0 */
    float *depth;
    uint32_t *marks;
    uint32_t *ids; /* NULL: not asked for; else, where there is a mark: first_id of the part found + triangle of it */
    size_t pixel_capacity;
    uint8_t *out;
    size_t out_stride_bytes;
    float cuts[CLIP_MAX_PLANES][4]; /* planes that cut, of x w, y w in pixels, z, w; those that rays come in by first */
    int cut_count, entry_count;
    float shift_px[2];  /* pixels are looked at so far from their middles */
    bool counts_bodies; /* planes that cut show which bodies are solid (caps.c) */
    bool blends;        /* some of what was found is blended */
    bool has_ground;
    bool greys;                                                                /* context has no colours */
    float sun_from_pixel[4][4], ground_from_pixel[3][3], ray_from_pixel[3][3]; /* columns */
    int stretch_px; /* of the sky: from SOFT_STRETCH_LEAST to SOFT_STRETCH_MOST, a power of two; 1: each pixel by itself */
};

struct soft_kernels;
struct soft { /* what all frames share */
    struct workers *workers;
    const struct soft_kernels *kernels;
    const struct gpu_scene *gpu_scene;
    const struct environments *environments;
    size_t material_count;                                /* of all models */
    uint32_t *material_of_model;                          /* the first, by number of the model */
    uint32_t *muted_ramps, *own_ramps, *ramp_of_material; /* colours, RAMP_STEPS to a row; row, by number of the material */
    struct soft_materials materials;
    lanes *shading;            /* by number of the material: BASE ... of refined_impl.h */
    const uint32_t *backdrops; /* struct sky */
    struct soft_tones *tones;
    uint32_t *glossy; /* of that version of a colour map: rows are colours in a light */
    uint64_t glossy_version;
    struct soft_light lights[SOFT_LIGHTS];
    uint64_t uses;
    struct soft_parts **parts;                      /* by number of the model, level; made when they are first needed */
    struct visibility_store kept[TIER_REFINED + 1]; /* struct visibility_buffer, of cameras that stand still; by tier */
    uint64_t shapes[SOFT_SHAPES];                   /* content_hash_shape of the last previews drawn */
    size_t shape_count;
    struct raster preview;
    struct refined *spare; /* refined frames that are under way hold their own */
};

/* From the GPU; NULL: out of memory, logged. */
const struct soft_light *soft_get_light(struct soft *soft, const struct light_set *set);
void soft_free_light(const struct soft *soft, struct soft_light *light);
/* Where colours are looked up: in that colour map, which must stay meanwhile. */
const uint32_t *soft_colormap(struct soft *soft, const struct shaded_colormap *colormap, bool glossy);
void raster_finish(struct raster *raster); /* drops its room; it can draw again */
size_t raster_bytes(const struct raster *raster);
void refined_destroy(struct refined **refined); /* &NULL is fine; leaves NULL */
size_t refined_bytes(const struct refined *refined);
/* The steps. */
void raster_aim(struct raster *raster, const struct light *light);                  /* the matrices from pixels */
void raster_aim_cuts(struct raster *raster);                                        /* before all that follows */
bool raster_is_cut_off(const struct raster *raster, const float at[4], int planes); /* x w, y w in pixels, z, w */
/* A box of the mesh: none of it is left by that plane; or some is not (*cut: as it was, else). */
bool raster_cuts_box(const struct raster *raster, const struct soft_mesh *mesh, int plane, const float low[3], const float high[3],
                     bool *cut);
/* Where the ray of that place in the picture comes into what is left: depth. 0: nowhere, or its eye is within. */
float raster_entry_depth(const struct raster *raster, float x, float y);
/* Meshes, and which of their parts may be seen; bodies: or bound what is cut open. False: out of memory. */
bool raster_find(struct raster *raster, bool bodies);
bool raster_find_only(struct raster *raster, int asset); /* the same of one, from both sides */
bool raster_find_ghosts(struct raster *raster); /* of what is only hinted at; and below, how much of a line each pixel has, of 255 */
bool raster_ghosts(struct raster *raster, uint8_t *veil, uint8_t bgr[3]); /* rows of width_px; marks are lost. False: out of memory */
void raster_paint_ghosts(const struct raster *raster, const uint8_t *veil, const uint8_t bgr[3]);
enum soft_output { SOFT_CAPS, SOFT_DEPTH, SOFT_COLORS };                 /* only marks of caps; marks and depth; and colours */
void raster_tiles(struct raster *raster, enum soft_output output);       /* of what was found */
bool raster_make_room(struct raster *raster, const struct frame *frame); /* false: out of memory */
enum soft_rim { RIM_NONE, RIM_LIGHT, RIM_DARK };
const uint8_t *raster_rim(const struct raster *raster); /* per pixel, rows of pitch_px; in place of depth */
/* What is needed to colour it again, while raster->ids says what is seen and the frame has all but rims: no ink and no markers yet. NULL:
   out of memory. */
struct visibility_buffer *raster_keep(struct raster *raster);
void raster_keep_rim(const struct raster *raster, struct visibility_buffer *buffer); /* likewise: depth is lost */
/* Keeps it, with the frame's markers. */
void soft_keep(struct soft *soft, const struct frame_context *context, struct visibility_buffer *buffer, const struct frame *frame);
struct soft_triangle {
    uint32_t id; /* of struct soft_sample, or of raster->ids */
    uint32_t mesh, material;
    uint32_t vertices[3]; /* of the file */
};
/* Finds which triangle of what was found has that id. triangle->mesh is looked at first: that of a neighbour, or 0. */
void raster_find_triangle(const struct raster *raster, uint32_t id, struct soft_triangle *triangle);
/* Of the corners of a triangle (vertices of the file), planes over the picture: up to a factor, the parts that they have of a place. */
void soft_weights(const struct soft_mesh *mesh, const uint32_t vertices[3], double weights[3][3]);
void raster_outline(const struct raster *raster); /* of all that has a mark; depth is lost */

#endif
