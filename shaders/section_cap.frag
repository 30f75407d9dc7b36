// SPDX-License-Identifier: GPL-3.0-or-later
// Draws section caps: colours the section plane where it cuts through closed bodies. Runs on all pixels of the resolved frame, once for
// colours and once for depth.
#include "frame.glsl"
#include "section.glsl"
// counts of bodies around the pixel's ray, from section_cap_count.frag; each pixel of the frame has `texels` x `texels` counts
layout(binding = 0) uniform sampler2D bodies;
layout(location = 0) uniform int texels;      // number of texels of `bodies` along a pixel's side
layout(location = 0) in vec2 clip;
#ifdef DEPTH
#else
layout(location = 0) out vec4 color;
#endif

// Returns the depth (1: near plane, 0: far plane) at which the pixel's ray enters the part of space that the section planes
// keep. 1: the ray begins in that part; negative: it misses that part.
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
