/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds shaded colour maps: tables of colour by position on the scale and by brightness. */
#include "render/shaded_colormap.h"

#include "base/mem.h"
#include "base/color/lab.h"

const uint8_t colormap_no_data[2][3] = { { HATCH_LIGHT_GREY, HATCH_LIGHT_GREY, HATCH_LIGHT_GREY },
                                         { HATCH_DARK_GREY, HATCH_DARK_GREY, HATCH_DARK_GREY } };
const uint8_t colormap_no_limits[2][3] = { { RULE_LIGHT_GREY, RULE_LIGHT_GREY, RULE_LIGHT_GREY },
                                           { RULE_DARK_GREY, RULE_DARK_GREY, RULE_DARK_GREY } };
const uint8_t colormap_uncertain[3] = { STIPPLE_GREY, STIPPLE_GREY, STIPPLE_GREY };

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

static void fill_texels(struct shaded_colormap *colormap, const struct scale *scale, const struct colormap_shades *shades)
{
    for (int column = 0; column < COLORMAP_COLUMNS; column++) {
        int color = color_of_column(scale, column);
        for (int row = 0; row < COLORMAP_ROWS; row++) {
            const uint8_t *rgb = shades->rgb[row][color];
            colormap->texels[row][column] = rgb[2] | (uint32_t)rgb[1] << 8 | (uint32_t)rgb[0] << 16 | 0xff000000;
        }
    }
}

static void fill_nearest(float nearest[COLORMAP_PLACES], const struct scale *scale, const double *lines, int count)
{
    for (int column = 0, line = 0; column < COLORMAP_PLACES; column++) {
        double place = (column + 0.5) / COLORMAP_PLACES;
        while (line + 1 < count && scale_place(scale, lines[line]) + scale_place(scale, lines[line + 1]) <= 2 * place)
            line++;
        nearest[column] = (float)scale_place(scale, lines[line]);
    }
}

void shaded_colormap_init(struct shaded_colormap *colormap, const struct scale *scale, const struct colormap_shades *shades,
                          const double *lines, int line_count)
{
    *colormap = (struct shaded_colormap){ .texels = mem_array(COLORMAP_ROWS, sizeof(*colormap->texels)) };
    fill_texels(colormap, scale, shades);
    colormap->colors = make_texture(GL_RGB8, COLORMAP_COLUMNS, COLORMAP_ROWS);
    glTextureSubImage2D(colormap->colors, 0, 0, 0, COLORMAP_COLUMNS, COLORMAP_ROWS, GL_BGRA, GL_UNSIGNED_BYTE, colormap->texels);
    if (line_count == 0)
        return;
    colormap->nearest = mem_array(COLORMAP_PLACES, sizeof(*colormap->nearest));
    fill_nearest(colormap->nearest, scale, lines, line_count);
    colormap->lines = make_texture(GL_R32F, COLORMAP_PLACES, 1);
    glTextureSubImage2D(colormap->lines, 0, 0, 0, COLORMAP_PLACES, 1, GL_RED, GL_FLOAT, colormap->nearest);
}

void shaded_colormap_finish(struct shaded_colormap *colormap)
{
    glDeleteTextures(1, &colormap->colors);
    glDeleteTextures(1, &colormap->lines);
    mem_free(colormap->texels);
    mem_free(colormap->nearest);
    *colormap = (struct shaded_colormap){ 0 };
}
