/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much of even surroundings a surface reflects: GGX with height-correlated Smith masking, as glTF has it. */
#include "render/light/environment.h"
#include "render/light/ggx.h"

enum { SAMPLES = 512 };

static void integrate(double n_v, double alpha, float scale_bias[2])
{
    double flat = sqrt(1 - n_v * n_v), a2 = alpha * alpha, scale = 0, bias = 0;
    for (unsigned i = 0; i < SAMPLES; i++) {
        double n_h = ggx_cosine(alpha, (i + 0.5) / SAMPLES), side = sqrt(1 - n_h * n_h) * cos(2 * M_PI * ggx_turn(i));
        double v_h = side * flat + n_h * n_v, n_l = 2 * v_h * n_h - n_v;
        if (n_l <= 0 || v_h <= 0)
            continue;
        double visible = 0.5 / (n_l * sqrt(n_v * n_v * (1 - a2) + a2) + n_v * sqrt(n_l * n_l * (1 - a2) + a2));
        double part = 4 * visible * n_l * v_h / n_h, fresnel = pow(1 - v_h, 5);
        scale += (1 - fresnel) * part / SAMPLES;
        bias += fresnel * part / SAMPLES;
    }
    scale_bias[0] = (float)scale;
    scale_bias[1] = (float)bias;
}

void environment_brdf(int side, float (*scale_bias)[2])
{
    for (int i = 0; i < side * side; i++) {
        double n_v = (i % side + 0.5) / side, roughness = (i / side + 0.5) / side;
        integrate(n_v, roughness * roughness, scale_bias[i]);
    }
}
