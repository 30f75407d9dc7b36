/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Maps values to positions on the colour scale, and positions to colours. */
#include "field/scale.h"

#include <math.h>
#include <string.h>

double scale_place(const struct scale *scale, double value)
{
    if (scale->log)
        return log(value / scale->min) / log(scale->max / scale->min);
    return (value - scale->min) / (scale->max - scale->min);
}

double scale_value(const struct scale *scale, double place)
{
    if (scale->log)
        return scale->min * pow(scale->max / scale->min, place);
    return scale->min + place * (scale->max - scale->min);
}

static bool is_inside(const struct scale *scale, double value)
{
    return value > scale->min && value < scale->max;
}

static double band_count(const struct scale *scale)
{
    return fmax(ceil((scale->max - scale->min) / scale->interval - 0.001), 1);
}

/* Returns the position (0..1) in the colour map of the colour of the band that contains the value. Comparison and division use
   floats: values are stored as floats, so in double precision a value at the edge of a band could be slightly below that edge. */
static double band_place(const struct scale *scale, double value)
{
    if (scale->break_count > 0) {
        int bands = 1, band = 0;
        for (int i = 0; i < scale->break_count; i++)
            if (is_inside(scale, scale->breaks[i])) {
                bands++;
                band += (float)value >= (float)scale->breaks[i];
            }
        return (band + 0.5) / bands;
    }
    float steps = ((float)value - (float)scale->min) / (float)scale->interval;
    double band = fmin(floor((double)steps), band_count(scale) - 1), begin = scale->min + fmax(band, 0) * scale->interval;
    return (scale_place(scale, begin) + scale_place(scale, fmin(begin + scale->interval, scale->max))) / 2;
}

int scale_index(const struct scale *scale, double value)
{
    if ((float)value < (float)scale->min)
        return SCALE_BELOW;
    if ((float)value > (float)scale->max)
        return SCALE_ABOVE;
    bool banded = scale->break_count > 0 || scale->interval > 0;
    double place = banded ? band_place(scale, value) : scale_place(scale, value);
    return (int)fmin(fmax((double)(float)place * 256, 0), 255);
}

void scale_look_up(const struct scale *scale, double value, uint8_t rgb[3])
{
    int index = scale_index(scale, value);
    const uint8_t *color = index == SCALE_BELOW ? scale->map->below : index == SCALE_ABOVE ? scale->map->above : scale->map->rgb[index];
    memcpy(rgb, color, 3);
}

int scale_edges(const struct scale *scale, double edges[SCALE_EDGES])
{
    int count = 0;
    if (scale->break_count > 0) {
        for (int i = 0; i < scale->break_count; i++)
            if (is_inside(scale, scale->breaks[i]))
                edges[count++] = scale->breaks[i];
        return count;
    }
    double bands = scale->interval > 0 ? band_count(scale) : 1;
    if (bands > SCALE_EDGES)
        return 0;
    for (int i = 1; i < bands; i++)
        edges[count++] = scale->min + i * scale->interval;
    return count;
}

double scale_step(const struct scale *scale)
{
    return (scale->log ? scale->min * log(scale->max / scale->min) : scale->max - scale->min) / 256;
}
