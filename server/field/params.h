/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parameters of a field: a session's choice of how the field is computed and which quantity is shown. Call from any thread. */
#ifndef FIELD_PARAMS_H
#define FIELD_PARAMS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "plant/plant.h"
#include "scene/scene.h"

enum field_show { SHOW_VALUE, SHOW_DISTANCE, SHOW_DIFFERENCE, SHOW_OPERATOR, SHOW_UNCERTAINTY, SHOW_BLIND };

/* One sensor's strength and decay, which replace those of the tag list. */
struct field_override {
    int tag;
    float strength, decay; /* FIELD_AS_CONFIGURED: not overridden */
};
#define FIELD_AS_CONFIGURED (-1.0f)
enum { FIELD_OVERRIDES = 256 };

/* A session's choices about its field. Compared byte by byte: zero-initialise all bytes, then call field_params_default(). */
struct field_params {
    int group;
    enum field_show show;
    int sensor;        /* index of the tag from which distances are shown; -1: none */
    uint32_t baseline; /* id of the baseline (stored earlier readings, value/baselines.h) that is subtracted from the readings; 0: none */
    /* id of the trial (set of sensor positions that a user tries out, field/trials.h) that the field uses; 0: the plant's
       positions */
    uint32_t trial;
    /* index of the slot in value/snapshot_cache.h with the past readings to show; 0: current readings. It makes the cache
       distinguish fields of different instants */
    int slot;
    enum interpolation interpolation;
    enum distance_mode distance;
    enum fill_mode fill;
    double strength, decay; /* factors applied to each sensor's configured strength and decay; 1: unchanged */
    /* power p of the interpolation shepard (inverse distance weighting): weights are proportional to 1 / distance^p */
    double power;
    /* radius R in metres of interpolation paper, in which the nearness of a sensor is max(0, 1 - distance / R); 0: R is the
       largest distance on the asset from any configured sensor */
    double radius_m;
    double reach_m;         /* INFINITY: no limit */
    size_t override_count;
    /* strengths and decays that replace those of the tag list, sorted by tag; unused elements are all zero */
    struct field_override overrides[FIELD_OVERRIDES];
};
/* Sets all parameters to the defaults that the plant file states for the shown group of sensors. */
void field_params_default(const struct plant *plant, int group, struct field_params *params);
/* Sets the shown quantity, and adapts the interpolation. `fin` lets values fall towards ambient, which makes no sense for
   `show: operator` (the position of each reading between its tag's limits): it is replaced by `harmonic`, or by `shepard` if
   `harmonic` is not prepared. Uncertainty uses `gp` wherever it is prepared. */
void field_params_set_show(const struct plant *plant, struct field_params *params, enum field_show show);
/* Returns how the distances from sensors are measured. Interpolations that plantcast-prep prepares have distances along the
   surface. */
enum distance_mode field_params_distance(const struct field_params *params);
bool field_params_equal(const struct field_params *a, const struct field_params *b);
/* Returns true if every sensor that the parameters name (`sensor`, overrides) belongs to the shown group and has a position. */
bool field_params_placed(const struct plant *plant, const struct field_params *params);
/* Checks the parameters: 0 <= strength, decay <= 100; 0.5 <= power <= 16; radius 0 or 1e-3..1e6 m; reach > 0. Returns NULL if
   they are valid, else what is wrong (static text). */
const char *field_params_wrong(const struct plant *plant, const struct field_params *params);
/* Sets one sensor's override; removes it if both values are FIELD_AS_CONFIGURED. Returns false if there is no room for another override. */
bool field_params_override(struct field_params *params, struct field_override override);
/* Returns the strength and decay that replace this tag's values in the tag list; NULL: nothing replaces them. Owned by params. */
const struct field_override *field_params_override_of(const struct field_params *params, int tag);
/* Returns true if the shown quantity depends only on which sensors are good, not on their readings. */
bool field_params_cover(const struct field_params *params);
/* Writes the default range of the colour map: the group's MIN and MAX; for distances 0 to the largest, rounded up; for
   differences a quarter of the range on either side of 0; for `show: operator` -3 to 3, the positions between a tag's alarm
   limits (field/limits.h); for uncertainty 0 to the standard deviation of `gp` without any reading (its prior); for hot spots a
   twentieth of the group's range to the whole range. */
void field_default_range(const struct scene *scene, const struct field_params *params, double *min, double *max);

#endif
