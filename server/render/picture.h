/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One picture being drawn: what every pass needs to know. Thread: the one of the GL context. */
#ifndef RENDER_PICTURE_H
#define RENDER_PICTURE_H
#include "gpu/target.h"
#include "render/fields.h"
#include "render/light/light.h"
#include "render/palettes.h"
#include "render/reference.h"
#include "render/view.h"

struct picture {
    const struct stage *stage;
    const struct view *view;
    struct shot shot;
    struct light_key lit_by;            /* what it is drawn with: what the view asks for, or the most alike */
    const struct light_set *light;
    const struct target *target;
    struct field *field;
    const struct fields_entry **fields; /* per asset; NULL: context */
    const int *visible;                 /* assets, nearest first */
    size_t visible_count;
    struct palette palette;
    struct reference *reference; /* NULL: the field is interpolated between vertices; else worked out at each fragment */
    double error_px;             /* of levels of detail, at most (render/detail.h); 0: no coarser ones */
    bool measured;               /* the field's numbers instead of colours, into floats */
};

#endif
