/* SPDX-License-Identifier: GPL-3.0-or-later */
/* By how much all that a wall shows is moved, so that nothing burns in. The page does the same (clients/web/core/wall.js). Pure. */
#ifndef PLANT_WALLS_BURN_SHIFT_H
#define PLANT_WALLS_BURN_SHIFT_H
#include <stdint.h>

#define BURN_SHIFT_PX 3 /* at most, in each direction */

struct burn_shift {
    int x_px, y_px; /* to the right, down */
};
/* Returns it at a time of the plant's clock: displays of a wall are moved together. */
struct burn_shift burn_shift_at(int64_t utc_ns);

#endif
