/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/support/cielab.h"

#include <math.h>

static double decode(double s)
{
    return s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4);
}

static double lab_curve(double t)
{
    return t > 216.0 / 24389 ? cbrt(t) : (24389.0 / 27 * t + 16) / 116;
}

static double lab_curve_inverse(double t)
{
    return t > 6.0 / 29 ? t * t * t : 3 * 36.0 / 841 * (t - 4.0 / 29);
}

void lab_from_linear(const double c[3], double lab[3])
{
    double x = lab_curve((0.4124564 * c[0] + 0.3575761 * c[1] + 0.1804375 * c[2]) / 0.9504700);
    double y = lab_curve(0.2126729 * c[0] + 0.7151522 * c[1] + 0.0721750 * c[2]);
    double z = lab_curve((0.0193339 * c[0] + 0.1191920 * c[1] + 0.9503041 * c[2]) / 1.0888300);
    lab[0] = 116 * y - 16;
    lab[1] = 500 * (x - y);
    lab[2] = 200 * (y - z);
}

void linear_from_lab(const double lab[3], double c[3])
{
    double fy = (lab[0] + 16) / 116;
    double x = lab_curve_inverse(fy + lab[1] / 500) * 0.95047, y = lab_curve_inverse(fy),
           z = lab_curve_inverse(fy - lab[2] / 200) * 1.08883;
    c[0] = 3.2404542 * x - 1.5371385 * y - 0.4985314 * z;
    c[1] = -0.9692660 * x + 1.8760108 * y + 0.0415560 * z;
    c[2] = 0.0556434 * x - 0.2040259 * y + 1.0572252 * z;
}

void see_without_green(double c[3])
{
    double r = 0.367322 * c[0] + 0.860646 * c[1] - 0.227968 * c[2], g = 0.280085 * c[0] + 0.672501 * c[1] + 0.047413 * c[2];
    double b = -0.011820 * c[0] + 0.042940 * c[1] + 0.968881 * c[2];
    c[0] = fmin(fmax(r, 0), 1);
    c[1] = fmin(fmax(g, 0), 1);
    c[2] = fmin(fmax(b, 0), 1);
}

void lab_of_rgb(const double rgb[3], bool deuteranope, double lab[3])
{
    double c[3];
    for (int k = 0; k < 3; k++)
        c[k] = decode(rgb[k] / 255);
    if (deuteranope)
        see_without_green(c);
    lab_from_linear(c, lab);
}

void lab_of(const uint8_t rgb[3], bool deuteranope, double lab[3])
{
    lab_of_rgb((double[3]){ rgb[0], rgb[1], rgb[2] }, deuteranope, lab);
}

double lab_distance(const double a[3], const double b[3])
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}
