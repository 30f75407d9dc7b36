/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Physically based shading (PBR) of eight surfaces at a time; a C version of shaders/environment.glsl, pbr.glsl and light.glsl. Private to
   soft/. */
#ifndef RENDER_SOFT_PBR_H
#define RENDER_SOFT_PBR_H
#include "render/light/environments.h"
#include "render/soft/tones.h"

struct brdf {
    lanes scale, bias;
};

SOFT_INLINE struct brdf brdf_at(const struct environment_light *surroundings, lanes n_v, lanes roughness)
{
    struct brdf out;
    enum { SIDE = ENVIRONMENT_BRDF_PX };
    lanes u = lanes_clamp(n_v * SIDE - 0.5f, 0, SIDE - 1), v = lanes_clamp(roughness * SIDE - 0.5f, 0, SIDE - 1);
    for (int i = 0; i < LANES; i++) {
        int x = (int)u[i], y = (int)v[i], right = x + 1 < SIDE ? 1 : 0, below = y + 1 < SIDE ? SIDE : 0;
        float a = u[i] - (float)x, b = v[i] - (float)y;
        const float(*texel)[2] = &surroundings->brdf[y * SIDE + x];
        float at[2];
        for (int c = 0; c < 2; c++) {
            float upper = texel[0][c] + a * (texel[right][c] - texel[0][c]);
            float lower = texel[below][c] + a * (texel[below + right][c] - texel[below][c]);
            at[c] = upper + b * (lower - upper);
        }
        out.scale[i] = at[0];
        out.bias[i] = at[1];
    }
    return out;
}

SOFT_INLINE vec sky_irradiance(const struct environment_light *surroundings, vec n)
{
    lanes terms[ENVIRONMENT_TERMS] = {
        all(1), n.y, n.z, n.x, n.x * n.y, n.y * n.z, 3.0f * n.z * n.z - 1.0f, n.x * n.z, n.x * n.x - n.y * n.y
    };
    lanes sum[3] = { all(0), all(0), all(0) };
    for (int t = 0; t < ENVIRONMENT_TERMS; t++)
        for (int c = 0; c < 3; c++)
            sum[c] += terms[t] * surroundings->of->irradiance[t][c];
    return (vec){ most_of(sum[0], all(0)), most_of(sum[1], all(0)), most_of(sum[2], all(0)) };
}

typedef float four __attribute__((vector_size(16), aligned(4)));

SOFT_INLINE four texel_between(const float (*texels)[4], float x, float y)
{
    int x0 = (int)x, y0 = (int)y, right = x0 + 1 < ENVIRONMENT_PX ? 1 : 0, below = y0 + 1 < ENVIRONMENT_PX ? ENVIRONMENT_PX : 0;
    float a = x - (float)x0, b = y - (float)y0;
    const float(*at)[4] = &texels[y0 * ENVIRONMENT_PX + x0];
    four p = *(const four *)at[0], q = *(const four *)at[right], r = *(const four *)at[below], s = *(const four *)at[below + right];
    four upper = p + (q - p) * a, lower = r + (s - r) * a;
    return upper + (lower - upper) * b;
}

/* Returns the environment's light around the direction r, averaged for a surface of this roughness. r: the view direction mirrored at the
   surface. */
SOFT_INLINE vec mirrored(const struct environment_light *surroundings, vec r, lanes roughness)
{
    const float(*texels)[4] = (const float(*)[4])surroundings->of->mirrored;
    const float side = ENVIRONMENT_PX, layers = ENVIRONMENT_LAYERS;
    lanes ax = most_of(r.x, -r.x), ay = most_of(r.y, -r.y), az = most_of(r.z, -r.z), over = 1.0f / (ax + ay + az);
    lanes u = r.x * over, v = r.y * over, one = all(1);
    lanes folded_u = (one - most_of(v, -v)) * lanes_choose(u >= 0.0f, one, -one);
    lanes folded_v = (one - most_of(u, -u)) * lanes_choose(v >= 0.0f, one, -one);
    u = lanes_choose(r.z < 0.0f, folded_u, u);
    v = lanes_choose(r.z < 0.0f, folded_v, v);
    u = lanes_clamp((u * 0.5f + 0.5f) * (side - 1), 0, side - 1);
    v = lanes_clamp((v * 0.5f + 0.5f) * (side - 1), 0, side - 1);
    lanes layer = lanes_clamp(roughness * (layers - 1), 0, layers - 1);
    vec out;
    for (int i = 0; i < LANES; i++) {
        int upper = (int)layer[i], lower = upper + 1 < ENVIRONMENT_LAYERS ? upper + 1 : upper;
        four a = texel_between(texels + upper * ENVIRONMENT_PX * ENVIRONMENT_PX, u[i], v[i]);
        four b = texel_between(texels + lower * ENVIRONMENT_PX * ENVIRONMENT_PX, u[i], v[i]);
        a += (b - a) * (layer[i] - (float)upper);
        out.x[i] = a[0];
        out.y[i] = a[1];
        out.z[i] = a[2];
    }
    return out;
}

struct pbr_surface {
    vec base, normal;
    lanes metallic, roughness, open, sun_visible;
};

SOFT_INLINE vec reflected_more(vec f0, struct brdf brdf)
{
    lanes lost = 1.0f - brdf.scale - brdf.bias;
    lanes f[3] = { f0.x, f0.y, f0.z }, out[3];
    for (int c = 0; c < 3; c++) {
        lanes mean = f[c] + (1.0f - f[c]) * (1 / 21.0f);
        out[c] = (f[c] * brdf.scale + brdf.bias) * mean / (1.0f - lost * mean) * lost;
    }
    return (vec){ out[0], out[1], out[2] };
}

struct sky_light { /* light that a surface receives from sky and surroundings, not yet multiplied by the surface's colour */
    struct brdf brdf;
    vec irradiance, seen;
};

SOFT_INLINE struct sky_light sky_light_at(const struct environment_light *surroundings, const struct pbr_surface *s, vec v)
{
    lanes n_v = lanes_clamp(dot(s->normal, v), 0, 1), a2 = s->roughness * s->roughness;
    vec reflected = plus(times(s->normal, 2.0f * dot(s->normal, v)), times(v, all(-1)));
    return (struct sky_light){
        .brdf = brdf_at(surroundings, n_v, s->roughness),
        .irradiance = sky_irradiance(surroundings, s->normal),
        .seen = mirrored(surroundings, between(reflected, s->normal, a2), s->roughness),
    };
}

SOFT_INLINE vec sky_shade(const struct sky_light *sky, const struct pbr_surface *s)
{
    struct brdf brdf = sky->brdf;
    vec f0 = between(grey(all((float)CLEAR_F0)), s->base, s->metallic), diffuse = times(s->base, 1.0f - s->metallic);
    vec clear = reflected_more(grey(all((float)CLEAR_F0)), brdf), more = between(clear, reflected_more(s->base, brdf), s->metallic);
    vec once = plus(times(f0, brdf.scale), grey(brdf.bias));
    vec left = plus(grey(1.0f - (float)CLEAR_F0 * brdf.scale - brdf.bias), times(clear, all(-1)));
    vec diffused = multiplied(plus(more, multiplied(diffuse, left)), sky->irradiance);
    return times(plus(diffused, multiplied(once, sky->seen)), (float)SKY_LIGHT * s->open);
}

SOFT_INLINE lanes ggx_visible(lanes n_l, lanes n_v, lanes n_h, lanes alpha)
{
    lanes a2 = alpha * alpha, d = n_h * n_h * (a2 - 1.0f) + 1.0f;
    lanes v = 0.5f / most_of(n_l * root(n_v * n_v * (1.0f - a2) + a2) + n_v * root(n_l * n_l * (1.0f - a2) + a2), all(1e-4f));
    return a2 / (d * d) * v;
}

SOFT_INLINE vec sun_shade(const struct pbr_surface *s, vec v, vec l)
{
    lanes n_v = most_of(dot(s->normal, v), all(1e-3f)), n_l = most_of(dot(s->normal, l), all(0));
    lanes roughness = most_of(s->roughness, all(0.1f));
    vec h = unit(plus(v, l)), f0 = between(grey(all((float)CLEAR_F0)), s->base, s->metallic), diffuse = times(s->base, 1.0f - s->metallic);
    lanes x = 1.0f - most_of(dot(v, h), all(0)), x2 = x * x;
    lanes grazing = x2 * x2 * x;
    vec fresnel = between(f0, grey(all(1)), grazing);
    lanes lobe = least_of(ggx_visible(n_l, n_v, most_of(dot(s->normal, h), all(0)), roughness * roughness), all(50));
    vec c = plus(times(diffuse, 0.96f - 0.96f * grazing), times(fresnel, lobe));
    return times(c, n_l * s->sun_visible * (float)SUN_LIGHT);
}

SOFT_INLINE lanes grey_of(vec c)
{
    return (float)GREY_RED * c.x + (float)GREY_GREEN * c.y + (float)GREY_BLUE * c.z;
}

SOFT_INLINE vec mute(vec c)
{
    return between(grey(grey_of(c)), grey(all((float)MUTED_GREY)), all((float)MUTED_PART));
}

#endif
