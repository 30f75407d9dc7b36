/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Interpolations with a physical meaning: plantcast-prep solves for what each sensor weighs at each vertex, and the daemon only adds
   (PLANT.md, *Interpolations with a meaning*). Thread: any. */
#ifndef PLANT_INFLUENCE_H
#define PLANT_INFLUENCE_H
#include "plant/plant.h"

#define PLANT_DISC_M 0.05       /* a clamped or welded sensor and what it touches */
#define PLANT_CONDUCTIVITY 50.0 /* W/(m K): carbon steel, EN 1993-1-2, 3.4.1.3: 54 - 0.0333 T, at about 100 deg C */
#define PLANT_HEAT_TRANSFER 9.0 /* W/(m2 K): still air with radiation, EN 1991-1-2, 3.1(6) */

#define PLANT_GP_DEVIATION 0.25 /* of the group's range: what is taken for the field's standard deviation */
#define PLANT_GP_NOISE 0.005    /* and for that of the noise of a reading */

#define PLANT_SEEN_PART 0.05 /* of the group's range: what can be seen in a picture as something */
#define PLANT_HOT_SPOT_M 0.5 /* how large the hot spots are that are asked for */

/* Returns whether an interpolation's weights are prepared; else they follow from distances. */
static inline bool interpolation_is_prepared(enum interpolation interpolation)
{
    return interpolation >= INTERPOLATION_HARMONIC;
}
/* Returns whether plantcast-prep computes this one for the group. */
static inline bool plant_prepares(const struct plant_group *group, enum interpolation interpolation)
{
    return group->prepared >> interpolation & 1;
}
/* Returns whether plantcast-prep computes any for the group, or distances as the paper finds them, or how directions are carried along. */
static inline bool plant_prepares_any(const struct plant_group *group)
{
    return group->prepared >> INTERPOLATION_HARMONIC != 0 || group->heat || group->directed;
}
/* Returns the decay length sqrt(k t / h) of an asset's wall, metres. Its thickness must be stated. */
double plant_decay_m(const struct plant_asset *asset);

#endif
