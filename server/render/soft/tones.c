/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fills the tables that convert linear light to sRGB and back (tones.h), and packs light into 32 bits. */
#include "render/soft/tones.h"

#include <math.h>

#include "base/image/srgb.h"

void soft_tones_init(struct soft_tones *tones)
{
    for (int i = 0; i <= TONES; i++)
        tones->srgb[i] = (float)srgb_from_linear((double)i / TONES);
    for (int i = 0; i < 256; i++)
        tones->linear[i] = (float)linear_from_srgb(i / 255.0);
}

uint32_t soft_pack_light(const float light[3])
{
    const float min_light = 0x1p-16f, max_light = 65408; /* range of the shared exponent */
    float brightest = fmaxf(fmaxf(light[0], light[1]), fmaxf(light[2], min_light));
    int exponent;
    /* the factor selects the next higher exponent if the brightest channel would otherwise round up to 512, which does not fit
       in nine bits */
    frexpf(fminf(brightest, max_light) * (1 + 0x1p-9f), &exponent);
    uint32_t packed = (uint32_t)(exponent + 15) << 27;
    for (int c = 0; c < 3; c++)
        packed |= (uint32_t)(ldexpf(fminf(fmaxf(light[c], 0), max_light), 9 - exponent) + 0.5f) << (9 * c);
    return packed;
}
