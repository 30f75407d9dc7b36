/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Slow shift of a wall display's whole content, so that still content does not burn into the screen. The page uses the same
   function (clients/web/core/wall.js). Pure. */
#ifndef PLANT_WALLS_BURN_SHIFT_H
#define PLANT_WALLS_BURN_SHIFT_H
#include <stdint.h>

#define BURN_SHIFT_PX 3 /* maximum shift of a display's content, in pixels to the left, right, up and down */

struct burn_shift {
    int x_px, y_px; /* shift of a display's content in pixels: x_px to the right, y_px down; negative: to the left, up */
};
/* Returns the shift of the displays at a time of the plant's clock. All displays of a wall use the same time, so their contents move
   together. */
struct burn_shift burn_shift_at(int64_t utc_ns);

#endif
