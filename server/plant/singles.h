/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Assets that have only one sensor of a group. With the interpolation `shepard`, the group's field is constant there. So
   plantcast-prep does not subdivide their triangles, unless the plant file asks for `paper` or `singles: cut`: on undivided
   triangles, neither `paper` nor distances are shown correctly. Sensors with an assumed place do not count. Call from any
   thread. */
#ifndef PLANT_SINGLES_H
#define PLANT_SINGLES_H
#include "plant/plant.h"

/* Returns whether plantcast-prep subdivides triangles even of assets with only one sensor of the group, so that `paper` and
   distances are shown correctly there. */
bool plant_cuts_singles(const struct plant_group *group);
/* Returns whether plantcast-prep subdivides triangles so that `paper` is shown correctly on an asset with this number of the
   group's sensors: not with more than 64, and with one only if plant_cuts_singles(). */
bool plant_cuts_for_paper(const struct plant_group *group, size_t sensor_count);
/* Counts the assets that have exactly one sensor of the group. Returns the count; if it is not 0, *first receives the index of the first
   such asset. */
size_t plant_singles(const struct plant *plant, int group, int *first);
/* Returns whether the tag is its group's only sensor on its asset. */
bool plant_is_single(const struct plant *plant, int tag);

#endif
