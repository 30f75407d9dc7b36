/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Colours by place and light. */
#include "render/shaded_colormap.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "field/lab.h"

const uint8_t colormap_no_data[2][3] = { { 240, 240, 240 }, { 150, 150, 150 } };
const uint8_t colormap_no_limits[2][3] = { { 226, 226, 226 }, { 196, 196, 196 } };
const uint8_t colormap_uncertain[3] = { 64, 64, 64 };

static const uint8_t *shaded_color(const struct colormap *map, int color)
{
    switch (color) {
    case SHADES_BELOW: return map->below;
    case SHADES_ABOVE: return map->above;
    case SHADES_PATTERNS + PATTERN_HATCH_LIGHT: return colormap_no_data[0];
    case SHADES_PATTERNS + PATTERN_HATCH_DARK: return colormap_no_data[1];
    case SHADES_PATTERNS + PATTERN_STIPPLE: return colormap_uncertain;
    case SHADES_PATTERNS + PATTERN_PLAIN_LIGHT: return colormap_no_limits[0];
    case SHADES_PATTERNS + PATTERN_PLAIN_DARK: return colormap_no_limits[1];
    default: return map->rgb[color];
    }
}

void colormap_shades_init(const struct colormap *map, struct colormap_shades *out)
{
    for (int row = 0; row < COLORMAP_ROWS; row++)
        for (int color = 0; color < SHADES_COLORS; color++)
            lab_shade(shaded_color(map, color), map->shading * (2.0 * row / (COLORMAP_ROWS - 1) - 1), out->rgb[row][color]);
}

static int color_of_column(const struct scale *scale, int column)
{
    if (column == COLORMAP_BELOW)
        return SHADES_BELOW;
    if (column == COLORMAP_ABOVE)
        return SHADES_ABOVE;
    if (column >= COLORMAP_PATTERNS)
        return SHADES_PATTERNS + column - COLORMAP_PATTERNS;
    return scale_index(scale, scale_value(scale, (column - 0.5) / COLORMAP_PLACES));
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

GLuint shaded_colormap_create(const struct scale *scale, const struct colormap_shades *shades)
{
    uint8_t(*texels)[COLORMAP_COLUMNS][3] = mem_array(COLORMAP_ROWS, sizeof(*texels));
    for (int column = 0; column < COLORMAP_COLUMNS; column++) {
        int color = color_of_column(scale, column);
        for (int row = 0; row < COLORMAP_ROWS; row++)
            memcpy(texels[row][column], shades->rgb[row][color], 3);
    }
    GLuint texture = make_texture(GL_RGB8, COLORMAP_COLUMNS, COLORMAP_ROWS);
    glTextureSubImage2D(texture, 0, 0, 0, COLORMAP_COLUMNS, COLORMAP_ROWS, GL_RGB, GL_UNSIGNED_BYTE, texels);
    mem_free(texels);
    return texture;
}

GLuint shaded_colormap_create_lines(const struct scale *scale, const double *lines, int count)
{
    float places[COLORMAP_PLACES];
    for (int column = 0, nearest = 0; column < COLORMAP_PLACES; column++) {
        double place = (column + 0.5) / COLORMAP_PLACES;
        while (nearest + 1 < count && scale_place(scale, lines[nearest]) + scale_place(scale, lines[nearest + 1]) <= 2 * place)
            nearest++;
        places[column] = (float)scale_place(scale, lines[nearest]);
    }
    GLuint texture = make_texture(GL_R32F, COLORMAP_PLACES, 1);
    glTextureSubImage2D(texture, 0, 0, 0, COLORMAP_PLACES, 1, GL_RED, GL_FLOAT, places);
    return texture;
}
