/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parameters of a field: what a session may choose of how it is computed, and what of it is shown. Thread: any. */
#ifndef FIELD_PARAMS_H
#define FIELD_PARAMS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "plant/plant.h"
#include "scene/scene.h"

enum field_show { SHOW_VALUE, SHOW_DISTANCE, SHOW_DIFFERENCE, SHOW_OPERATOR, SHOW_UNCERTAINTY, SHOW_BLIND };

/* One sensor's strength and decay, in place of the tag list's. */
struct field_override {
    int tag;
    float strength, decay; /* FIELD_AS_CONFIGURED: not overridden */
};
#define FIELD_AS_CONFIGURED (-1.0f)
enum { FIELD_OVERRIDES = 256 };

/* What a session may choose about its field. Compared byte for byte: zero-initialise, then call field_params_default(). */
struct field_params {
    int group;
    enum field_show show;
    int sensor;        /* tag whose distance is shown; -1: none */
    uint32_t baseline; /* id of what the difference is from; 0: none */
    uint32_t trial;    /* places of sensors that are tried out (field/trials.h); 0: none */
    int slot;          /* of the instant that the readings are of (value/snapshot_cache.h): its fields are kept apart; 0: now */
    enum interpolation interpolation;
    enum distance_mode distance;
    enum fill_mode fill;
    double strength, decay; /* factors on each sensor's own; 1 = as configured */
    double power;           /* shepard's p */
    double radius_m;        /* paper's R; 0 = the largest distance on the asset over all its configured sensors */
    double reach_m;         /* INFINITY: no limit */
    size_t override_count;
    struct field_override overrides[FIELD_OVERRIDES]; /* in order of tags; 0 beyond the count */
};
/* Fills in the group's defaults from the plant file. */
void field_params_default(const struct plant *plant, int group, struct field_params *params);
/* Sets what is shown. Places between limits cannot be interpolated by `fin`, whose values fall towards what is around: `harmonic`, or
   where it is not prepared `shepard`, then takes its place. Uncertainty is that of `gp`, wherever it is prepared. */
void field_params_set_show(const struct plant *plant, struct field_params *params, enum field_show show);
/* Returns whether two sets of parameters are equal. */
bool field_params_equal(const struct field_params *a, const struct field_params *b);
/* Returns whether each sensor that the parameters name has a place in the shown group. */
bool field_params_placed(const struct plant *plant, const struct field_params *params);
/* Checks the parameters: 0 <= strength, decay <= 100; 0.5 <= power <= 16; radius 0 or 1e-3..1e6 m; reach > 0. Returns NULL if they are
   valid, else a static text that says what is wrong. */
const char *field_params_wrong(const struct plant *plant, const struct field_params *params);
/* Sets one sensor's override; drops it where both values are FIELD_AS_CONFIGURED. Returns false if there is no room for another. */
bool field_params_override(struct field_params *params, struct field_override override);
/* Returns the tag's override, or NULL. Belongs to params. */
const struct field_override *field_params_override_of(const struct field_params *params, int tag);
/* Returns whether what is shown depends on which sensors are good, and not on what they say. */
bool field_params_cover(const struct field_params *params);
/* Writes the default range of the colour map: the group's MIN and MAX; for distances 0 to the largest, rounded up; for differences a
   quarter of the range below and above 0; for the operator's view all positions between limits; for uncertainty 0 to
   the deviation of the prior; for hot spots a twentieth of the group's range to all of it. */
void field_default_range(const struct scene *scene, const struct field_params *params, double *min, double *max);

#endif
