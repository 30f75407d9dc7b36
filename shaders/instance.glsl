// SPDX-License-Identifier: GPL-3.0-or-later
// Per-asset data for draw calls that draw several assets. It consists of the asset's placement and, per vertex, the light and
// the field (value interpolated between sensors), in buffers that many assets share (gpu/pool.h). The layout must match struct
// draw_instance.

// rows of the matrix for normals. Fourth elements of the three rows: index of the asset's first block in `lights`; index of its
// first block in `scalars` (-1: the asset has no values of sensors); unused
layout(location = 4) in mat3x4 eye_from_normal;
layout(location = 8) in mat4 clip_from_file;
// rows of the matrix from coordinates of the asset file to eye space; in previews (frames in lower quality): to texture
// coordinates and depth of the sun's shadow map
layout(location = 12) in mat3x4 from_file;
layout(binding = 12) uniform samplerBuffer lights;
// per vertex: the value interpolated between sensors, as float bits, then one byte each for the shares of no data, uncertain
// and no alarm limits
layout(binding = 13) uniform usamplerBuffer scalars;

vec4 light_here()
{
    return texelFetch(lights, int(eye_from_normal[0].w) * 64 + gl_VertexID);
}

// Returns the field at the vertex: the value interpolated between sensors, and flags. For assets without values of sensors, the
// flags say "no data".
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
