// SPDX-License-Identifier: GPL-3.0-or-later
// What a cut shows of closed bodies: a plane where it enters them. Over the resolved picture; once for colours, once for depth.
#include "frame.glsl"
#include "section.glsl"
layout(binding = 0) uniform sampler2D bodies; // of section_cap_count.frag; several texels to a pixel
layout(location = 0) uniform int texels;      // to a pixel's side
layout(location = 0) in vec2 clip;
#ifdef DEPTH
#else
layout(location = 0) out vec4 color;
#endif

// Where the ray enters what is left of the plant: depth, 1 near; 1: it begins within, below 0: it misses it.
float entry()
{
    float top = 1.0, bottom = 0.0;
    for (int i = 0; i < 6; i++) {
        float here = dot(frame.clip[i].xyw, vec3(clip, 1.0)), rise = frame.clip[i].z;
        if (rise > 0.0)
            bottom = max(bottom, -here / rise);
        else if (rise < 0.0)
            top = min(top, -here / rise);
        else if (here < 0.0)
            return -1.0;
    }
    return top > bottom ? top : -1.0;
}

void main()
{
    float depth = entry(), part = 0.0;
    if (depth < 0.0 || depth >= 1.0)
        discard;
    ivec2 first = ivec2(gl_FragCoord.xy) * texels;
    for (int y = 0; y < texels; y++)
        for (int x = 0; x < texels; x++)
            part += texelFetch(bodies, first + ivec2(x, y), 0).r > 0.5 ? 1.0 : 0.0;
    part /= float(texels * texels);
#ifdef DEPTH
    if (part < 0.5)
        discard;
    gl_FragDepth = depth;
#else
    if (part == 0.0)
        discard;
    color = vec4(cap_color(), part);
#endif
}
