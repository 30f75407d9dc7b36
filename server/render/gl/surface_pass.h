/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pass that draws the surfaces of all visible assets, for previews and refined frames. Call only in the thread that owns the GL
   context. */
#ifndef RENDER_GL_SURFACE_PASS_H
#define RENDER_GL_SURFACE_PASS_H
#include "render/gl/draw_batches.h"
#include "render/gl/occlusion.h"
#include "render/gl/sensor_cells.h"
#include "render/frame_context.h"

/* Features compiled into a shader program, combined by bitwise or. Each draw call uses the program with the fewest features
   that it needs, since a software GL runs every branch. FIELD: colours of a field. RICH: also isolines and non-linear scales;
   RICH without FIELD: the surface is grey. */
enum surface_variant {
    SURFACE_FIELD = 1,
    SURFACE_RICH = 2,
    SURFACE_GLOSSY = 4,
    SURFACE_TEXTURED = 8,
    SURFACE_CLIP = 16,
    SURFACE_VARIANTS = 32
};

/* Kind of a surface program: whether it writes colours or (MEASURE) field values, and where the field is computed. Programs of
   all kinds but SURFACE_PICTURE are compiled on first use. */
enum surface_program_kind {
    SURFACE_PICTURE,
    SURFACE_PIXEL_FIELD,
    SURFACE_PER_FRAGMENT,
    SURFACE_MEASURE,
    SURFACE_MEASURE_PIXEL_FIELD,
    SURFACE_MEASURE_PER_FRAGMENT,
    SURFACE_KINDS
};

struct surface_pass {
    struct log *log;
    struct occlusion occlusion;
    struct sensor_grids sensor_grids;
    /* minimum number of triangles in a frame for occlusion culling; INT_MAX: none, but clusters outside the frustum are still culled */
    int least_hiding;
    bool one_by_one; /* true: each asset is drawn with its own GL calls instead of in batches; for comparison in tests */
    struct draw_batches opaque, blended;
    /* number of triangles submitted to GL so far, excluding culled ones; the caller sets it to 0 for each frame */
    int triangles;
    GLuint programs[SURFACE_KINDS][2][SURFACE_VARIANTS]; /* [kind][refined][features]; 0: not compiled yet */
    GLuint depth_programs[2][2]; /* programs that write only depth: [refined][with section planes]; 0: not compiled yet */
};

/* Compiles those programs that draw pictures from values at vertices (SURFACE_PICTURE); others are compiled on first use. On
   failure, logs the reason and returns false. */
bool surface_pass_init(struct surface_pass *pass, struct log *log);
void surface_pass_finish(struct surface_pass *pass);
/* Makes the lists of near sensors of those fields of the visible assets whose lists are missing or out of date. Call after
   fields_upload(), before drawing. */
void surface_pass_prepare(struct surface_pass *pass, struct fields *fields, const struct frame_context *context);
/* Draw the visible assets in steps. surface_pass_draw_some() draws opaque submeshes from the visible asset `first` on, until it
   has drawn about `triangles` triangles; it returns the index at which to continue. surface_pass_draw_blended() then draws all
   transparent submeshes. */
size_t surface_pass_draw_some(struct surface_pass *pass, const struct frame_context *context, size_t first, int triangles);
void surface_pass_draw_blended(struct surface_pass *pass, const struct frame_context *context);

#endif
