/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Places for arrows, spread evenly over an asset whose field has directions. They are tested for visibility with the isolines' points, and
   drawn by whoever draws labels. Thread: the one of the GL context. */
#ifndef RENDER_PICK_ARROWS_H
#define RENDER_PICK_ARROWS_H
#include "field/directions.h"
#include "render/plan/fields.h"

struct arrow_set { /* of one asset; zero-initialise, finish with arrows_finish() */
    struct direction_place *places; /* those that are farthest apart come first */
    struct direction *found;
    size_t count;
    double spacing_m; /* about so far apart, were all of them drawn */
    float error_m;    /* of the level that they lie on */
    bool sought;      /* places are there, if there are any */
    uint64_t content; /* what `found` was found from */
};

/* Returns how many of an asset's first vertices must have current scalars. Pure. */
size_t arrows_vertex_count(const struct scene_asset *asset);
/* Brings the directions up to date with what the entry shows. */
void arrows_update(struct arrow_set *set, const struct scene *scene, int asset, const struct fields_entry *field);
/* Returns the field's value at a place, in its unit; NaN where there is no data. */
double arrows_value(const struct arrow_set *set, size_t place, const struct fields_entry *field);
/* Likewise at any place of the asset's file. */
double arrows_value_at(const struct direction_place *at, const struct fields_entry *field);
/* Writes where a place is, and where an arrow points there, in the plant frame. */
void arrows_place(const struct arrow_set *set, size_t place, const struct scene_asset *asset, double place_m[3], double along[3]);
/* Likewise, of a place of the asset's file and its direction. */
void arrows_place_at(const struct direction_place *at, const struct direction *to, const struct scene_asset *asset, double place_m[3],
                     double along[3]);
void arrows_finish(struct arrow_set *set);

#endif
