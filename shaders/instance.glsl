// SPDX-License-Identifier: GPL-3.0-or-later
// Per-asset data for draw calls that draw several assets: placement, and light and field per vertex, in buffers that many
// assets share (gpu/pool.h). The layout must match struct draw_instance.

// rows of the matrix for normals. Their fourth elements: index of the asset's first block in `lights`; index of its first block in
// `scalars` (-1: no field); unused
layout(location = 4) in mat3x4 eye_from_normal;
layout(location = 8) in mat4 clip_from_file;
// rows of the matrix from file coordinates to eye space; in previews: to texture coordinates and depth of the sun's shadow map
layout(location = 12) in mat3x4 from_file;
layout(binding = 12) uniform samplerBuffer lights;
// per vertex: the field's value as float bits, then one byte each for no data, uncertain and no limits
layout(binding = 13) uniform usamplerBuffer scalars;

vec4 light_here()
{
    return texelFetch(lights, int(eye_from_normal[0].w) * 64 + gl_VertexID);
}

// Returns the field at the vertex; for assets without a field, "no data".
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
