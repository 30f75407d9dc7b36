/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plant's palette: restrained, as a paint schedule would have it. */
#include "material.h"

const struct material_look material_looks[MATERIAL_COUNT] = {
    [MATERIAL_CLADDING] = { "aluminium cladding", { 0.86, 0.87, 0.88 }, 0.85, 0.38 },
    [MATERIAL_STAINLESS] = { "stainless steel", { 0.80, 0.79, 0.77 }, 0.95, 0.30 },
    [MATERIAL_GALVANISED] = { "galvanised steel", { 0.66, 0.69, 0.70 }, 0.70, 0.52 },
    [MATERIAL_BOLTING] = { "zinc-plated bolting", { 0.58, 0.60, 0.61 }, 0.55, 0.48 },
    [MATERIAL_VESSEL] = { "painted steel, light grey", { 0.80, 0.82, 0.81 }, 0.0, 0.45 },
    [MATERIAL_TANK] = { "painted steel, white", { 0.90, 0.90, 0.87 }, 0.0, 0.42 },
    [MATERIAL_PIPE] = { "painted steel, pipe grey", { 0.62, 0.65, 0.66 }, 0.0, 0.48 },
    [MATERIAL_CHANNEL] = { "painted steel, blue grey", { 0.38, 0.47, 0.54 }, 0.0, 0.42 },
    [MATERIAL_PUMP] = { "pump enamel", { 0.16, 0.34, 0.50 }, 0.0, 0.38 },
    [MATERIAL_MOTOR] = { "motor enamel", { 0.30, 0.43, 0.40 }, 0.0, 0.45 },
    [MATERIAL_STRUCTURE] = { "structural paint", { 0.44, 0.50, 0.52 }, 0.0, 0.55 },
    [MATERIAL_COOLING_WATER] = { "painted steel, water green", { 0.28, 0.46, 0.38 }, 0.0, 0.48 },
    [MATERIAL_SAFETY_YELLOW] = { "safety yellow", { 0.93, 0.73, 0.12 }, 0.0, 0.48 },
    [MATERIAL_HANDWHEEL] = { "handwheel red", { 0.64, 0.16, 0.13 }, 0.0, 0.45 },
    [MATERIAL_ACTUATOR] = { "actuator ochre", { 0.76, 0.45, 0.18 }, 0.0, 0.45 },
    [MATERIAL_INSTRUMENT] = { "instrument blue", { 0.20, 0.38, 0.62 }, 0.0, 0.40 },
    [MATERIAL_BLACK] = { "black rubber", { 0.13, 0.13, 0.14 }, 0.0, 0.80 },
    [MATERIAL_CONCRETE] = { "concrete slab", { 0.66, 0.65, 0.62 }, 0.0, 0.92 },
    [MATERIAL_PLINTH] = { "concrete plinth", { 0.74, 0.73, 0.70 }, 0.0, 0.90 },
    [MATERIAL_JOINT] = { "joint sealant", { 0.50, 0.50, 0.48 }, 0.0, 0.95 },
    [MATERIAL_GRAVEL] = { "gravel", { 0.58, 0.56, 0.52 }, 0.0, 0.98 },
};
