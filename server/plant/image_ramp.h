/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A colour map out of an image: the row of pixels along its longest axis, through its middle; from left to right, or from the bottom up.
   The colours are taken as they stand in the file (sRGB), those between pixels interpolated likewise, as a texture's are. Thread: any. */
#ifndef PLANT_IMAGE_RAMP_H
#define PLANT_IMAGE_RAMP_H
#include <stdbool.h>
#include <stdint.h>

#include "base/image.h"

/* False: why says what is wrong with the file. */
bool image_ramp(const char *path, uint8_t rgb[256][3], char why[IMAGE_WHY_BYTES]);

#endif
