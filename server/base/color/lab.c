/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Conversions of colour spaces (CIE 15:2004, IEC 61966-2-1). */
#include "base/color/lab.h"

#include <math.h>
#include <string.h>

#include "base/image/srgb.h"

static const double white[3] = { 0.95047, 1.0, 1.08883 };

static void see_without_green(double c[3])
{
    static const double seen[3][3] = { { 0.367322, 0.860646, -0.227968 },
                                       { 0.280085, 0.672501, 0.047413 },
                                       { -0.011820, 0.042940, 0.968881 } };
    const double from[3] = { c[0], c[1], c[2] };
    for (int i = 0; i < 3; i++)
        c[i] = fmin(fmax(seen[i][0] * from[0] + seen[i][1] * from[1] + seen[i][2] * from[2], 0), 1);
}

void lab_from_srgb(const double srgb[3], enum color_vision vision, double lab[3])
{
    static const double to_xyz[3][3] = { { 0.4124564, 0.3575761, 0.1804375 },
                                         { 0.2126729, 0.7151522, 0.0721750 },
                                         { 0.0193339, 0.1191920, 0.9503041 } };
    double f[3], linear[3];
    for (int c = 0; c < 3; c++)
        linear[c] = linear_from_srgb(srgb[c] / 255);
    if (vision == VISION_DEUTERANOPE)
        see_without_green(linear);
    for (int i = 0; i < 3; i++) {
        double t = 0;
        for (int c = 0; c < 3; c++)
            t += to_xyz[i][c] * linear[c];
        t /= white[i];
        f[i] = t > 216.0 / 24389 ? cbrt(t) : (24389.0 / 27 * t + 16) / 116;
    }
    lab[0] = 116 * f[1] - 16;
    lab[1] = 500 * (f[0] - f[1]);
    lab[2] = 200 * (f[1] - f[2]);
}

void lab_from_rgb(const uint8_t rgb[3], double lab[3])
{
    lab_from_srgb((double[3]){ rgb[0], rgb[1], rgb[2] }, VISION_NORMAL, lab);
}

/* Converts CIELAB to sRGB. Returns false if sRGB has no such colour; rgb is then clamped. */
static bool rgb_from_lab(const double lab[3], uint8_t rgb[3])
{
    static const double to_rgb[3][3] = { { 3.2404542, -1.5371385, -0.4985314 },
                                         { -0.9692660, 1.8760108, 0.0415560 },
                                         { 0.0556434, -0.2040259, 1.0572252 } };
    static const double slack = 0.5 / 255;
    double f1 = (lab[0] + 16) / 116, f[3] = { f1 + lab[1] / 500, f1, f1 - lab[2] / 200 }, xyz[3];
    for (int i = 0; i < 3; i++)
        xyz[i] = white[i] * (f[i] > 6.0 / 29 ? f[i] * f[i] * f[i] : (116 * f[i] - 16) * 27 / 24389);
    bool inside = true;
    for (int c = 0; c < 3; c++) {
        double value = srgb_from_linear(to_rgb[c][0] * xyz[0] + to_rgb[c][1] * xyz[1] + to_rgb[c][2] * xyz[2]);
        inside = inside && value > -slack && value < 1 + slack;
        rgb[c] = (uint8_t)lround(255 * fmin(fmax(value, 0), 1));
    }
    return inside;
}

void lab_shade(const uint8_t rgb[3], double offset, uint8_t out[3])
{
    double lab[3], lightness, reach = 1;
    lab_from_rgb(rgb, lab);
    lightness = lab[0];
    memcpy(out, rgb, 3);
    if (offset == 0)
        return;
    /* near the border of the sRGB gamut, the colour shifted by the whole offset of L* may not exist in sRGB: tries smaller and
       smaller parts of the offset, with the same hue and chroma */
    for (int step = 0; step < 24; step++, reach -= 1.0 / 24) {
        lab[0] = lightness + reach * offset;
        if (rgb_from_lab(lab, out))
            return;
    }
    memcpy(out, rgb, 3);
}
