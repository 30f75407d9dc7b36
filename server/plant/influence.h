/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Interpolations with a physical meaning. plantcast-prep computes the weight of each sensor at each vertex, so the daemon only
   forms weighted sums of the readings (INTERPOLATIONS.md, *Interpolations that solve an equation*). Call from any thread. */
#ifndef PLANT_INFLUENCE_H
#define PLANT_INFLUENCE_H
#include "plant/plant.h"

#define PLANT_DISC_M 0.05       /* default radius in metres of the patch of surface that a clamped or welded sensor touches */
/* default heat conductivity of an asset's wall, W/(m K): carbon steel, EN 1993-1-2, 3.4.1.3: 54 - 0.0333 T, at about 100 deg C */
#define PLANT_CONDUCTIVITY 50.0
/* default heat transfer coefficient from an asset's wall to its surroundings, W/(m2 K): still air with radiation, EN 1991-1-2, 3.1(6) */
#define PLANT_HEAT_TRANSFER 9.0

/* assumed standard deviation of the field (interpolated values) of `gp`, as a fraction of the group's range */
#define PLANT_GP_DEVIATION 0.25
/* correlation length of `gp` as a fraction of the asset's size, used if there are no readings to determine it from */
#define PLANT_GP_RANGE 0.25
#define PLANT_GP_FITTED 3       /* minimum number of sensors on an asset to determine the parameters of `gp` from readings */
#define PLANT_GP_NOISE 0.005    /* assumed standard deviation of a reading's noise for `gp`, as a fraction of the group's range */

#define PLANT_SEEN_PART 0.05 /* smallest difference of values visible as a difference of colours, as a fraction of the group's range */
/* default radius in metres of the hot spots that `show: blind` considers (hot_spot_m in struct plant_group) */
#define PLANT_HOT_SPOT_M 0.5

/* Returns whether plantcast-prep computes the weights of an interpolation; false: the daemon computes them from distances. */
static inline bool interpolation_is_prepared(enum interpolation interpolation)
{
    return interpolation >= INTERPOLATION_HARMONIC;
}
/* Returns the kind of distance with which an interpolation measures. Those computed by plantcast-prep measure along the surface,
   whatever kind the group or the user has chosen. */
static inline enum distance_mode interpolation_distance(enum interpolation interpolation, enum distance_mode chosen)
{
    return interpolation_is_prepared(interpolation) ? DISTANCE_GEODESIC : chosen;
}
/* Returns whether plantcast-prep computes this interpolation for the group. */
static inline bool plant_prepares(const struct plant_group *group, enum interpolation interpolation)
{
    return group->prepared >> interpolation & 1;
}
/* Returns whether plantcast-prep computes anything for the group: an interpolation, heat-method distances, or the transport of
   directions along the surface. */
static inline bool plant_prepares_any(const struct plant_group *group)
{
    return group->prepared >> INTERPOLATION_HARMONIC != 0 || group->heat || group->directed;
}
/* Returns the decay length of heat along an asset's wall in metres: sqrt(k t / h), with the conductivity k, the wall thickness
   t and the heat transfer coefficient h. The plant file must give the wall thickness. */
double plant_decay_m(const struct plant_asset *asset);
/* Sets *noise and *deviation, parameters of `gp`, to defaults for the group's range if they are NaN. */
void plant_gp_defaults(const struct plant_group *group, double *noise, double *deviation);

#endif
