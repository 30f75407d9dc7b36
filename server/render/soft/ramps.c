/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes colour ramps (ramps.h): the colours of a material from the darkest to the brightest light. */
#include "render/soft/ramps.h"

#include "base/image/srgb.h"
#include "render/soft/pbr.h"

static uint32_t color_of(vec linear, int i, bool muted)
{
    vec srgb = { all((float)srgb_from_linear((double)lanes_clamp(linear.x, 0, 1)[i])),
                 all((float)srgb_from_linear((double)lanes_clamp(linear.y, 0, 1)[i])),
                 all((float)srgb_from_linear((double)lanes_clamp(linear.z, 0, 1)[i])) };
    vec c = muted ? mute(srgb) : srgb;
    return (uint32_t)(255 * c.z[0] + 0.5f) | (uint32_t)(255 * c.y[0] + 0.5f) << 8 | (uint32_t)(255 * c.x[0] + 0.5f) << 16 | 0xff000000;
}

/* Computes a material's colour ramp (its colours from dark to bright) for a surface that faces up and is seen from a typical
   direction. */
void ramp_fill(const struct environment_light *sky, const double up[3], const struct ramp_material *material, bool muted, int steps,
               uint32_t *colors)
{
    vec n = { all((float)up[0]), all((float)up[1]), all((float)up[2]) };
    vec v = unit(plus(times(n, all(0.7f)), (vec){ 0.7f * n.y, 0.7f * n.z, 0.7f * n.x }));
    struct pbr_surface surface = { .base = { all(material->mean[0]), all(material->mean[1]), all(material->mean[2]) },
                                   .normal = n,
                                   .metallic = all(material->metallic),
                                   .roughness = all(fmaxf(material->roughness, 0.6f)) };
    vec glow = { all(material->emissive[0]), all(material->emissive[1]), all(material->emissive[2]) };
    struct sky_light around = sky_light_at(sky, &surface, v);
    for (int first = 0; first < steps; first += LANES) {
        lanes light = (LANES_IOTA + (float)first) * (1 / (float)(steps - 1));
        lanes sun = most_of(light - 0.45f, all(0)) * (1 / 0.55f);
        /* share of the sky in a surface's light: the first 0.45 of the brightness is assumed to come from the sky, the rest from the sun */
        surface.open = (light - (float)LIGHT_SUN * sun) * (1 / (float)LIGHT_AMBIENT);
        vec c = plus(sky_shade(&around, &surface), times(surface.base, sun * ((1 - 0.5f * material->metallic) * (float)SUN_LIGHT)));
        c = tone_map(plus(c, glow));
        for (int i = 0; i < LANES; i++)
            colors[first + i] = color_of(c, i, muted);
    }
}

void ramp_fill_glossy(uint32_t color, int steps, uint32_t *colors, int stride)
{
    vec base = { all(linear_from_srgbf((float)(color >> 16 & 0xff) / 255)), all(linear_from_srgbf((float)(color >> 8 & 0xff) / 255)),
                 all(linear_from_srgbf((float)(color & 0xff) / 255)) };
    for (int first = 0; first < steps; first += LANES) {
        vec c = tone_map(times(base, (LANES_IOTA + (float)first) * (1 / (float)(steps - 1)) + (float)GLOSSY_DARKEST));
        for (int i = 0; i < LANES && first + i < steps; i++)
            colors[(first + i) * stride] = color_of(c, i, false);
    }
}
