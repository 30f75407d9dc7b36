/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the steps of a preview hand to each other. Private to soft/. */
#ifndef RENDER_SOFT_SOFT_IMPL_H
#define RENDER_SOFT_SOFT_IMPL_H
#include "render/soft/flags.h"
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
    uint16_t *sun_map;    /* rows from the top; one more row and column than it has */
    int sun_map_px;
    uint32_t *ground; /* a byte each: this texel, its right, lower, lower right neighbour; 255: no shadow */
    int ground_px;
    uint64_t used;
};
enum { SOFT_LIGHTS = 2, SOFT_SHAPES = 16 };

struct soft_kernels;
struct soft {
    struct workers *workers;
    const struct soft_kernels *kernels;
    const struct gpu_scene *gpu_scene;
    size_t material_count;                               /* of all models */
    uint32_t *material_of_model;                         /* the first, by number of the model */
    uint32_t *muted_ramps, *own_ramps, *ramp_of_material; /* colours, RAMP_STEPS to a row; row, by number of the material */
    const struct soft_material *materials;               /* the keeper's */
    const uint32_t *backdrops; /* struct sky */
    const uint32_t *colormap;  /* the picture's, and below: struct shaded_colormap, or glossy */
    const float *lines;
    uint32_t *glossy;       /* of that version: rows are colours in a light */
    uint64_t glossy_version;
    struct soft_light lights[SOFT_LIGHTS];
    uint64_t uses;
    struct visibility_store kept; /* struct visibility_buffer, of cameras that stand still */
    uint64_t shapes[SOFT_SHAPES]; /* content_hash_shape of the last pictures drawn */
    size_t shape_count;
    struct soft *keeper;       /* of the parts and materials that it draws: itself, or another */
    struct soft_materials own_materials;
    struct soft_parts **parts; /* by number of the model, level; made when they are first needed */
    /* --- of the picture being drawn */
    const struct frame_context *context;
    const struct soft_light *light;
    const uint32_t *ramps; /* the picture's */
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

/* From the GPU; NULL: out of memory, logged. */
const struct soft_light *soft_get_light(struct soft *soft, const struct light_set *set);
void soft_free_light(const struct soft *soft, struct soft_light *light);
/* Looks colours up in that one from now on; it must stay until the picture is drawn. */
void soft_take_colormap(struct soft *soft, const struct shaded_colormap *colormap, bool glossy);
/* The steps. */
void soft_aim(struct soft *soft, const struct light *light);                  /* the matrices from pixels */
void soft_aim_cuts(struct soft *soft);                                        /* before all that follows */
bool soft_is_cut_off(const struct soft *soft, const float at[4], int planes); /* x w, y w in pixels, z, w */
/* A box of the mesh: none of it is left by that plane; or some is not (*cut: as it was, else). */
bool soft_cuts_box(const struct soft *soft, const struct soft_mesh *mesh, int plane, const float low[3], const float high[3], bool *cut);
/* Where the ray of that place in the picture comes into what is left: depth. 0: nowhere, or its eye is within. */
float soft_entry_depth(const struct soft *soft, float x, float y);
/* Meshes, and which of their parts may be seen; bodies: or bound what is cut open. False: out of memory. */
bool soft_find(struct soft *soft, bool bodies);
bool soft_find_only(struct soft *soft, int asset); /* the same of one, from both sides */
bool soft_find_ghosts(struct soft *soft);          /* of what is only hinted at; and below, how much of a line each pixel has, of 255 */
bool soft_ghosts(struct soft *soft, uint8_t *veil, uint8_t bgr[3]); /* rows of width_px; marks are lost. False: out of memory */
void soft_paint_ghosts(const struct soft *soft, const uint8_t *veil, const uint8_t bgr[3]);
enum soft_output { SOFT_CAPS, SOFT_DEPTH, SOFT_COLORS };           /* only marks of caps; marks and depth; and colours */
void soft_tiles(struct soft *soft, enum soft_output output);       /* of what was found */
bool soft_make_room(struct soft *soft, const struct frame *frame); /* false: out of memory */
enum soft_rim { RIM_NONE, RIM_LIGHT, RIM_DARK };
const uint8_t *soft_rim(const struct soft *soft); /* per pixel, rows of pitch_px; in place of depth */
/* What is needed to colour it again, while soft->ids says what is seen and the frame has all but rims: no ink and no markers yet. NULL:
   out of memory. */
struct visibility_buffer *soft_keep(struct soft *soft);
void soft_keep_rim(const struct soft *soft, struct visibility_buffer *buffer); /* likewise: depth is lost */
/* Hands it over to a store, with the frame's markers. */
void soft_give(struct visibility_store *store, const struct frame_context *context, struct visibility_buffer *buffer,
               const struct frame *frame);
/* Pixels, markers and labels, if the store has such a picture. points: of its isolines. False: it has not. */
bool soft_resolve_again(struct soft *soft, struct visibility_store *store, const struct frame_context *context,
                        const struct isoline_points *points, struct frame *frame);
struct soft_triangle {
    uint32_t id; /* of struct soft_sample, or of soft->ids */
    uint32_t mesh, material;
    uint32_t vertices[3]; /* of the file */
};
/* Finds which triangle of what was found has that id. triangle->mesh is looked at first: that of a neighbour, or 0. */
void soft_find_triangle(const struct soft *soft, uint32_t id, struct soft_triangle *triangle);
/* Of the corners of a triangle (vertices of the file), planes over the picture: up to a factor, the parts that they have of a place. */
void soft_weights(const struct soft_mesh *mesh, const uint32_t vertices[3], double weights[3][3]);
void soft_outline(const struct soft *soft); /* of all that has a mark; depth is lost */

#endif
