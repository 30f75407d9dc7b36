/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Assets with a single sensor of a group. By shepard the group's field is constant there, and plantcast-prep leaves their triangles whole,
   unless the plant file asks for paper or says `singles: cut`. On whole triangles neither paper nor distances can be drawn truly. Sensors
   whose place is assumed do not count. Thread: any. */
#ifndef PLANT_SINGLES_H
#define PLANT_SINGLES_H
#include "plant/plant.h"

/* Tells whether triangles are cut for paper and distances where the group has a single sensor, too. */
bool plant_cuts_singles(const struct plant_group *group);
/* Counts the assets with exactly one sensor of the group. Returns their number; *first is the first one's index where there is any. */
size_t plant_singles(const struct plant *plant, int group, int *first);
/* Tells whether the tag is its group's only sensor on its asset. */
bool plant_is_single(const struct plant *plant, int tag);

#endif
