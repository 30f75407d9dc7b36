/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Position of a reading between its own tag's alarm limits, for the operator's view. The limits have the positions LL -2, L -1,
   H +1 and HH +2, and the middle has 0; in between, the position is linear. Positions are clamped to -3..+3. They make the
   readings of different tags comparable: each position says how close the reading is to its own limits. The rule for the high
   side follows; the low side is its mirror image. "Inner limit" is H, or HH if there is no H: - The middle is half-way between
   the inner limits of both sides. If only one side has limits, the other end of the group's range replaces the missing inner
   limit; if that end lies beyond the existing limit, the middle is the point half a range away from that limit. - From the
   middle (0), the position rises to +1 at H, and on to +2 at HH. Beyond HH, the slope continues. - H without HH: the slope from
   the middle continues beyond H, to just below +2. - HH without H: the position stays below +1 up to HH, is +2 at HH, and then
   rises with half the slope from the middle to HH. Pure. Call from any thread. */
#ifndef FIELD_LIMITS_H
#define FIELD_LIMITS_H
#include "plant/plant.h"

#define LIMIT_PLACE_MOST 3.0
/* Returns a reading's position between its tag's limits, by the rule in the first comment of this file; NaN if the tag has no
   limits. value must be finite. */
double limit_place(const struct plant_group *group, const struct plant_tag *tag, double value);

#endif
