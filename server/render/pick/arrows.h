/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Positions of arrows, spread evenly over an asset whose field has directions. The visibility of arrows is tested together with
   isoline labels (isolines.h); the overlay or the client draws the arrows. Call only in the thread that owns the GL context. */
#ifndef RENDER_PICK_ARROWS_H
#define RENDER_PICK_ARROWS_H
#include "field/directions.h"
#include "render/plan/fields.h"

struct arrow_set {                  /* arrows that show the field's directions on one asset; zero-initialise, free with arrows_finish() */
    struct direction_place *places; /* positions of arrows, ordered so that the first n positions, for any n, are evenly spread */
    struct direction *found;
    size_t count;
    double spacing_m; /* approximate distance in metres between neighbouring arrows if all are drawn */
    float error_m;    /* error in metres of the level of detail that the positions lie on */
    bool sought;      /* `places` has been computed */
    uint64_t content; /* hash of the sensor directions used to compute the directions in `found` */
};

/* Returns how many of the asset's vertices, counted from the first, need current field values because arrows read them. Pure. */
size_t arrows_vertex_count(const struct scene_asset *asset);
/* Computes the directions of the asset's arrows from the sensor directions in `field`, if these have changed. */
void arrows_update(struct arrow_set *set, const struct scene *scene, int asset, const struct fields_entry *field);
/* Returns the field's value at the arrow position with index `place`, in the field's unit; NaN where there is no data. */
double arrows_value(const struct arrow_set *set, size_t place, const struct asset_view *file, const struct fields_entry *field);
/* Returns the field's value at any surface position, given as a triangle and corner weights; NaN where there is no data. */
double arrows_value_at(const struct direction_place *at, const struct asset_view *file, const struct fields_entry *field);
/* Writes the position with index `place` and the arrow's direction there, both in the plant frame. */
void arrows_place(const struct arrow_set *set, size_t place, const struct scene_asset *asset, double place_m[3], double along[3]);
/* Transforms a position and a direction from the asset file's coordinates to the plant frame. */
void arrows_place_at(const struct direction_place *at, const struct direction *to, const struct scene_asset *asset, double place_m[3],
                     double along[3]);
void arrows_finish(struct arrow_set *set);

#endif
