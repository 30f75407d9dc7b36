/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes how much shading may change a map's colours before viewers misread the values. */
#include <math.h>
#include <stdlib.h>

#include "base/color/colormap.h"
#include "base/color/lab.h"

/* largest accepted error of a value read from a colour: 3 % of the map's 256 colours */
static const double MAX_MISREAD = 0.03 * 256;
/* fraction of samples whose value must be read correctly. Stricter than the 0.95 promised for pictures (`safe` in struct
   colormap), because extreme light is more common in pictures than in these samples */
static const double MIN_RIGHT_PART = 0.974;
static const double MIN_SHADING = 2, UNSAFE_SHADING = 4, STEP = 0.5;
/* amplitude of the noise added to luma and chroma in turn, on a scale of 0..255: about that of JPEG at quality 80 */
static const double NOISE_AMPLITUDE = 2.0;
enum { SAMPLED = 5, STEPS = 4, NOISES = 6 };

static int nearest(const double labs[256][3], const double lab[3])
{
    double least = INFINITY;
    int found = 0;
    for (int i = 0; i < 256; i++) {
        double square = 0;
        for (int c = 0; c < 3; c++)
            square += (lab[c] - labs[i][c]) * (lab[c] - labs[i][c]);
        if (square < least) {
            least = square;
            found = i;
        }
    }
    return found;
}

static void add_noise(const uint8_t rgb[3], int noise, double out[3])
{
    /* directions of luma Y and chroma Cb and Cr in RGB space */
    static const double axes[3][3] = { { 1, 1, 1 }, { 0, -0.344136, 1.772 }, { 1.402, -0.714136, 0 } };
    for (int c = 0; c < 3; c++)
        out[c] = fmin(fmax(rgb[c] + (noise % 2 ? -NOISE_AMPLITUDE : NOISE_AMPLITUDE) * axes[noise / 2][c], 0), 255);
}

/* Returns true if at least MIN_RIGHT_PART of the shaded colours are read correctly: the value of the nearest legend colour differs by at
   most MAX_MISREAD. */
static bool is_read_right(const struct colormap *map, enum color_vision vision, double shading)
{
    double labs[256][3];
    int right = 0, all = 0;
    for (int i = 0; i < 256; i++)
        lab_from_srgb((double[3]){ map->rgb[i][0], map->rgb[i][1], map->rgb[i][2] }, vision, labs[i]);
    for (int i = 0; i < 256; i += SAMPLED)
        for (int step = -STEPS; step <= STEPS; step++) {
            uint8_t rgb[3];
            lab_shade(map->rgb[i], shading * step / STEPS, rgb);
            for (int noise = 0; noise < NOISES; noise++, all++) {
                double seen[3], lab[3];
                add_noise(rgb, noise, seen);
                lab_from_srgb(seen, vision, lab);
                right += abs(nearest(labs, lab) - i) <= MAX_MISREAD;
            }
        }
    return right >= MIN_RIGHT_PART * all;
}

void colormap_rate_shading(struct colormap *map)
{
    double shading = COLORMAP_SHADING, normal = 0;
    for (map->safe = false; shading >= MIN_SHADING && !map->safe; shading -= STEP) {
        bool good = is_read_right(map, VISION_NORMAL, shading);
        normal = good && normal == 0 ? shading : normal;
        map->safe = good && is_read_right(map, VISION_DEUTERANOPE, shading);
        map->shading = shading;
    }
    if (!map->safe)
        map->shading = normal > 0 ? normal : UNSAFE_SHADING;
}
