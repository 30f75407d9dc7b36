// SPDX-License-Identifier: GPL-3.0-or-later
// Unpacks normals that gpu/mesh.c packed: octahedral mapping (Cigolle et al. 2014, "A survey of efficient representations for independent
// unit vectors", oct32).
vec3 unfold_normal(vec2 folded)
{
    vec3 n = vec3(folded, 1.0 - abs(folded.x) - abs(folded.y));
    float below = max(-n.z, 0.0);
    n.xy -= mix(vec2(-below), vec2(below), greaterThanEqual(n.xy, vec2(0.0)));
    return normalize(n);
}
