/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The position of a reading between the limits of its own tag, for the operator's view: LL -2, L -1, H +1, HH +2, 0 in the middle, linear
   in between, clamped to -3 and +3. Readings of different tags become comparable: each shows how far it is from its own trouble.
   The rule for the high side (the low side is its mirror image); "inner" is H, or HH if there is no H:
   Middle: half-way between the inner limits; with limits on one side only, the other end of the group's range (or, if that is beyond the
   limit, half the range away from it).
   From the middle (0) to the inner limit (+1); without HH the slope continues to just below +2.
   From H (+1) to HH (+2); the slope continues beyond HH.
   HH without H: no reading below HH is beyond a limit, so the position stays below +1 there, is +2 at HH, and continues with half the slope
   below HH. Pure. Thread: any. */
#ifndef FIELD_LIMITS_H
#define FIELD_LIMITS_H
#include "plant/plant.h"

#define LIMIT_PLACE_MOST 3.0
/* Returns a reading's position between its tag's limits, by the rule in this file's first comment; NaN if the tag has no limits. value must
   be finite. */
double limit_place(const struct plant_group *group, const struct plant_tag *tag, double value);

#endif
