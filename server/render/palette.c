/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Colours shaded in CIELAB (D65). */
#include "render/palette.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

const uint8_t palette_no_data[2][3] = { { 240, 240, 240 }, { 150, 150, 150 } };
const uint8_t palette_no_limits[2][3] = { { 226, 226, 226 }, { 196, 196, 196 } };
const uint8_t palette_uncertain[3] = { 64, 64, 64 };

static const double white[3] = { 0.95047, 1.0, 1.08883 };

static double linear_from_srgb(double c)
{
    return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

static double srgb_from_linear(double c)
{
    return c <= 0.0031308 ? c * 12.92 : 1.055 * pow(c, 1 / 2.4) - 0.055;
}

static void lab_from_rgb(const uint8_t rgb[3], double lab[3])
{
    static const double to_xyz[3][3] = { { 0.4124564, 0.3575761, 0.1804375 },
                                         { 0.2126729, 0.7151522, 0.0721750 },
                                         { 0.0193339, 0.1191920, 0.9503041 } };
    double f[3];
    for (int i = 0; i < 3; i++) {
        double t = 0;
        for (int c = 0; c < 3; c++)
            t += to_xyz[i][c] * linear_from_srgb(rgb[c] / 255.0);
        t /= white[i];
        f[i] = t > 216.0 / 24389 ? cbrt(t) : (24389.0 / 27 * t + 16) / 116;
    }
    lab[0] = 116 * f[1] - 16;
    lab[1] = 500 * (f[0] - f[1]);
    lab[2] = 200 * (f[1] - f[2]);
}

/* False: sRGB has no such colour. */
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

void palette_shade(const uint8_t rgb[3], double offset, uint8_t out[3])
{
    double lab[3], lightness, reach = 1;
    lab_from_rgb(rgb, lab);
    lightness = lab[0];
    memcpy(out, rgb, 3);
    if (offset == 0)
        return;
    for (int step = 0; step < 24; step++, reach -= 1.0 / 24) { /* near the rim of sRGB the offset shrinks; hue and chroma stay */
        lab[0] = lightness + reach * offset;
        if (rgb_from_lab(lab, out))
            return;
    }
    memcpy(out, rgb, 3);
}

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

/* Of the map's colours, shaded by steps up to amplitude: the part that the nearest colour of the legend misreads by more than 3 %. */
static double misread_part(const struct colormap *map, const double labs[256][3], double amplitude)
{
    int wrong = 0, all = 0;
    for (int column = 0; column < 256; column += 3)
        for (int step = -4; step <= 4; step++, all++) {
            uint8_t rgb[3];
            double lab[3];
            palette_shade(map->rgb[column], amplitude * step / 4, rgb);
            lab_from_rgb(rgb, lab);
            wrong += abs(nearest(labs, lab) - column) > 0.03 * 256;
        }
    return (double)wrong / all;
}

double palette_amplitude(const struct colormap *map)
{
    double labs[256][3], amplitude = PALETTE_SHADING;
    for (int i = 0; i < 256; i++)
        lab_from_rgb(map->rgb[i], labs[i]);
    while (amplitude > 1 && misread_part(map, labs, amplitude) > 0.05)
        amplitude -= 0.5;
    return amplitude;
}

static const uint8_t *shaded_color(const struct colormap *map, int color)
{
    switch (color) {
    case SHADED_BELOW: return map->below;
    case SHADED_ABOVE: return map->above;
    case SHADED_PATTERNS + PATTERN_HATCH_LIGHT: return palette_no_data[0];
    case SHADED_PATTERNS + PATTERN_HATCH_DARK: return palette_no_data[1];
    case SHADED_PATTERNS + PATTERN_STIPPLE: return palette_uncertain;
    case SHADED_PATTERNS + PATTERN_PLAIN_LIGHT: return palette_no_limits[0];
    case SHADED_PATTERNS + PATTERN_PLAIN_DARK: return palette_no_limits[1];
    default: return map->rgb[color];
    }
}

void palette_shade_map(const struct colormap *map, struct shaded *out)
{
    /* Greys and tints of few steps are told apart by hue, not by lightness. */
    double amplitude = map == colormap_operator() ? PALETTE_SHADING : palette_amplitude(map);
    for (int row = 0; row < PALETTE_ROWS; row++)
        for (int color = 0; color < SHADED_COLORS; color++)
            palette_shade(shaded_color(map, color), amplitude * (2.0 * row / (PALETTE_ROWS - 1) - 1), out->rgb[row][color]);
}

static int color_of_column(const struct scale *scale, int column)
{
    if (column == PALETTE_BELOW)
        return SHADED_BELOW;
    if (column == PALETTE_ABOVE)
        return SHADED_ABOVE;
    if (column >= PALETTE_PATTERNS)
        return SHADED_PATTERNS + column - PALETTE_PATTERNS;
    return scale_index(scale, scale_value(scale, (column - 0.5) / PALETTE_PLACES));
}

static GLuint make_texture(GLenum format, int columns, int rows)
{
    GLuint texture = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    glTextureStorage2D(texture, 1, format, columns, rows);
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return texture;
}

GLuint palette_create(const struct scale *scale, const struct shaded *shaded)
{
    uint8_t(*texels)[PALETTE_COLUMNS][3] = mem_array(PALETTE_ROWS, sizeof(*texels));
    for (int column = 0; column < PALETTE_COLUMNS; column++) {
        int color = color_of_column(scale, column);
        for (int row = 0; row < PALETTE_ROWS; row++)
            memcpy(texels[row][column], shaded->rgb[row][color], 3);
    }
    GLuint texture = make_texture(GL_RGB8, PALETTE_COLUMNS, PALETTE_ROWS);
    glTextureSubImage2D(texture, 0, 0, 0, PALETTE_COLUMNS, PALETTE_ROWS, GL_RGB, GL_UNSIGNED_BYTE, texels);
    mem_free(texels);
    return texture;
}

GLuint palette_create_lines(const struct scale *scale, const double *lines, int count)
{
    float places[PALETTE_PLACES];
    for (int column = 0, nearest = 0; column < PALETTE_PLACES; column++) {
        double place = (column + 0.5) / PALETTE_PLACES;
        while (nearest + 1 < count && scale_place(scale, lines[nearest]) + scale_place(scale, lines[nearest + 1]) <= 2 * place)
            nearest++;
        places[column] = (float)scale_place(scale, lines[nearest]);
    }
    GLuint texture = make_texture(GL_R32F, PALETTE_PLACES, 1);
    glTextureSubImage2D(texture, 0, 0, 0, PALETTE_PLACES, 1, GL_RED, GL_FLOAT, places);
    return texture;
}
