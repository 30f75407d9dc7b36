// SPDX-License-Identifier: GPL-3.0-or-later
// What differs between assets that are drawn by one call: where they stand, and numbers by vertex, each asset's somewhere in a buffer that
// many share (gpu/pool.h). Same layout as struct draw_instance.
layout(location = 4) in mat3x4 eye_from_normal; // three rows; then the first block of light, of the field (-1: none), nothing
layout(location = 8) in mat4 clip_from_file;
layout(location = 12) in mat3x4 from_file; // as rows: to eye space; moving: to texture coordinates and depth of the shadow map
layout(binding = 12) uniform samplerBuffer lights;
layout(binding = 13) uniform usamplerBuffer scalars; // bits of a float; no data, uncertain, no limits by bytes

vec4 light_here()
{
    return texelFetch(lights, int(eye_from_normal[0].w) * 64 + gl_VertexID);
}

// Without a field: no data.
FIELD_TYPE scalar_here()
{
    int block = int(eye_from_normal[1].w);
    uvec2 texel = block < 0 ? uvec2(0u, 255u) : texelFetch(scalars, block * 64 + gl_VertexID).xy;
    float value = uintBitsToFloat(texel.x);
    vec3 flags = unpackUnorm4x8(texel.y).xyz;
#ifdef RICH
    return vec4(value, flags);
#else
    return vec3((value - frame.scale.x) * frame.scale.y, flags.xy);
#endif
}
