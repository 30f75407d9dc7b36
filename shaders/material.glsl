// SPDX-License-Identifier: GPL-3.0-or-later
// glTF 2.0 metallic-roughness materials; the layout must match render/gl/materials.c.
struct Material {
    vec4 base_color;
    vec4 factors;  // metallic, roughness, normal scale, occlusion strength
    vec4 emissive; // rgb; alpha cutoff (0: opaque)
};
layout(std430, binding = 0) readonly buffer Materials {
    Material materials[];
};
