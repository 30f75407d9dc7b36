/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pass that draws the plant itself, in either tier. Thread: the one of the GL context. */
#ifndef RENDER_SOLID_H
#define RENDER_SOLID_H
#include "render/bundles.h"
#include "render/occlusion.h"
#include "render/picture.h"

/* What a program can do; each does only what it must, since a software GL runs every branch. Rich: lines, and
   scales that are not linear; without a field, only greys. */
enum solid_variant { SOLID_FIELD = 1, SOLID_RICH = 2, SOLID_GLOSSY = 4, SOLID_TEXTURED = 8, SOLID_CLIP = 16, SOLID_VARIANTS = 32 };

/* What the programs are for; all but pictures are made when first needed. */
enum solid_kind { SOLID_PICTURE, SOLID_PER_FRAGMENT, SOLID_MEASURE, SOLID_MEASURE_PER_FRAGMENT, SOLID_KINDS };

struct solid {
    struct log *log;
    struct occlusion occlusion;
    int least_hiding; /* of pictures of so many triangles what others hide is left out; INT_MAX: of none, but clusters that are not seen */
    bool one_by_one; /* each asset by calls of its own: to compare */
    struct bundles solids, blended;
    int triangles; /* drawn without those that are not seen; whoever wants to know sets it to 0 before */
    GLuint programs[SOLID_KINDS][2][SOLID_VARIANTS]; /* by tier; 0: not used, or not made yet */
};

bool solid_init(struct solid *solid, struct log *log); /* false: logged */
void solid_finish(struct solid *solid);
void solid_draw(struct solid *solid, const struct picture *picture);
/* The same in parts: what is not blended, of the visible assets from `first` on, until about so many triangles are drawn; returns the
   first that is left. Then all that is blended. */
size_t solid_draw_some(struct solid *solid, const struct picture *picture, size_t first, int triangles);
void solid_draw_blended(struct solid *solid, const struct picture *picture);
const struct model_level *solid_level(const struct picture *picture, int asset); /* what of it is drawn */
double solid_sun_slack(const struct picture *picture); /* in depth of the sun's map: by how much surfaces are moved towards the sun */
int solid_triangles(const struct picture *picture); /* of what is drawn */

#endif
