/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pass that draws the plant itself, in either tier. Thread: the one of the GL context. */
#ifndef RENDER_GL_SURFACE_PASS_H
#define RENDER_GL_SURFACE_PASS_H
#include "render/gl/draw_batches.h"
#include "render/gl/occlusion.h"
#include "render/frame_context.h"

/* What a program can do; each does only what it must, since a software GL runs every branch. Rich: lines, and
   scales that are not linear; without a field, only greys. */
enum surface_variant {
    SURFACE_FIELD = 1,
    SURFACE_RICH = 2,
    SURFACE_GLOSSY = 4,
    SURFACE_TEXTURED = 8,
    SURFACE_CLIP = 16,
    SURFACE_VARIANTS = 32
};

/* What the programs are for; all but pictures are made when first needed. */
enum surface_program_kind { SURFACE_PICTURE, SURFACE_PER_FRAGMENT, SURFACE_MEASURE, SURFACE_MEASURE_PER_FRAGMENT, SURFACE_KINDS };

struct surface_pass {
    struct log *log;
    struct occlusion occlusion;
    int least_hiding; /* of pictures of so many triangles what others hide is left out; INT_MAX: of none, but clusters that are not seen */
    bool one_by_one;  /* each asset by calls of its own: to compare */
    struct draw_batches opaque, blended;
    int triangles; /* drawn without those that are not seen; whoever wants to know sets it to 0 before */
    GLuint programs[SURFACE_KINDS][2][SURFACE_VARIANTS]; /* by tier; 0: not used, or not made yet */
};

bool surface_pass_init(struct surface_pass *pass, struct log *log); /* false: logged */
void surface_pass_finish(struct surface_pass *pass);
void surface_pass_draw(struct surface_pass *pass, const struct frame_context *context);
/* The same in parts: what is not blended, of the visible assets from `first` on, until about so many triangles are drawn; returns the
   first that is left. Then all that is blended. */
size_t surface_pass_draw_some(struct surface_pass *pass, const struct frame_context *context, size_t first, int triangles);
void surface_pass_draw_blended(struct surface_pass *pass, const struct frame_context *context);
const struct model_level *surface_pass_level(const struct frame_context *context, int asset); /* what of it is drawn */
double
surface_pass_sun_slack(const struct frame_context *context); /* in depth of the sun's map: by how much surfaces are moved towards the sun */
int surface_pass_triangles(const struct frame_context *context); /* of what is drawn */

#endif
