/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the fraction of a uniform environment's light that a surface reflects, by roughness and viewing angle: GGX with
   height-correlated Smith masking, as glTF specifies. */
#include "render/light/environment.h"
#include "render/light/ggx.h"

enum { SAMPLES = 512 };

struct facets { /* sampled half vectors (microfacet normals) of a surface of one roughness, distributed by GGX */
    double alpha, n_h[SAMPLES], side[SAMPLES];
};

static void make_facets(double alpha, struct facets *facets)
{
    facets->alpha = alpha;
    for (unsigned i = 0; i < SAMPLES; i++) {
        double n_h = ggx_cosine(alpha, (i + 0.5) / SAMPLES);
        facets->n_h[i] = n_h;
        facets->side[i] = sqrt(1 - n_h * n_h) * cos(2 * M_PI * ggx_turn(i));
    }
}

static void integrate(const struct facets *facets, double n_v, float scale_bias[2])
{
    double flat = sqrt(1 - n_v * n_v), a2 = facets->alpha * facets->alpha, scale = 0, bias = 0;
    for (int i = 0; i < SAMPLES; i++) {
        double n_h = facets->n_h[i], v_h = facets->side[i] * flat + n_h * n_v, n_l = 2 * v_h * n_h - n_v;
        if (n_l <= 0 || v_h <= 0)
            continue;
        double visible = 0.5 / (n_l * sqrt(n_v * n_v * (1 - a2) + a2) + n_v * sqrt(n_l * n_l * (1 - a2) + a2));
        double part = 4 * visible * n_l * v_h / n_h, off = 1 - v_h, fresnel = off * off * off * off * off;
        scale += (1 - fresnel) * part / SAMPLES;
        bias += fresnel * part / SAMPLES;
    }
    scale_bias[0] = (float)scale;
    scale_bias[1] = (float)bias;
}

void environment_brdf(int side, float (*scale_bias)[2])
{
    struct facets facets;
    for (int y = 0; y < side; y++) {
        double roughness = (y + 0.5) / side;
        make_facets(roughness * roughness, &facets);
        for (int x = 0; x < side; x++)
            integrate(&facets, (x + 0.5) / side, scale_bias[y * side + x]);
    }
}
