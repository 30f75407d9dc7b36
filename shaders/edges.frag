// SPDX-License-Identifier: GPL-3.0-or-later
// Thin dark lines where depth breaks: silhouettes and sharp steps. Depth over screen is a plane on any flat surface, so a
// second difference that is not zero is an edge.
layout(binding = 0) uniform sampler2D depth;
layout(location = 0) in vec2 clip;
layout(location = 0) out vec4 color;

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(depth, 0) - 1;
    float c = texelFetch(depth, at, 0).r;
    float l = texelFetch(depth, max(at - ivec2(1, 0), ivec2(0)), 0).r, r = texelFetch(depth, min(at + ivec2(1, 0), last), 0).r;
    float u = texelFetch(depth, max(at - ivec2(0, 1), ivec2(0)), 0).r, d = texelFetch(depth, min(at + ivec2(0, 1), last), 0).r;
    float step = max(l + r, u + d) - 2.0 * c; // only on the farther side: one pixel wide, and not on the field of what stands in front
    float edge = smoothstep(0.004, 0.03, step / max(max(max(l, r), max(u, d)), 1e-9));
    if (edge <= 0.0)
        discard;
    color = vec4(0.08, 0.10, 0.14, 0.55 * edge);
}
