/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Colours by place and light. */
#include "render/palette.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "field/lab.h"

const uint8_t palette_no_data[2][3] = { { 240, 240, 240 }, { 150, 150, 150 } };
const uint8_t palette_no_limits[2][3] = { { 226, 226, 226 }, { 196, 196, 196 } };
const uint8_t palette_uncertain[3] = { 64, 64, 64 };

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
    for (int row = 0; row < PALETTE_ROWS; row++)
        for (int color = 0; color < SHADED_COLORS; color++)
            lab_shade(shaded_color(map, color), map->shading * (2.0 * row / (PALETTE_ROWS - 1) - 1), out->rgb[row][color]);
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
