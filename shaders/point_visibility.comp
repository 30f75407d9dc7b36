// SPDX-License-Identifier: GPL-3.0-or-later
// Projects points (markers, isoline labels, arrows) into the frame, and tests against the depth buffer whether a surface hides each.
#include "frame.glsl"
layout(local_size_x = 64) in;
struct Marker {
    vec4 place;  // input: position in eye space, metres; w: depth tolerance in metres. Output: x, y in pixels; z: 1 if hidden, else 0
};
layout(std430, binding = 0) buffer Markers { Marker markers[]; };
layout(location = 0) uniform int count;
layout(binding = 0) uniform sampler2D depth;

void main()
{
    int i = int(gl_GlobalInvocationID.x);
    if (i >= count)
        return;
    vec4 place = markers[i].place;
    vec3 towards = frame.back.w > 0.0 ? frame.back.xyz * place.w : -place.xyz * min(place.w / max(length(place.xyz), 1e-6), 0.5);
    vec4 clip = frame.clip_from_eye * vec4(place.xyz, 1.0), near = frame.clip_from_eye * vec4(place.xyz + towards, 1.0);
    vec2 size = vec2(textureSize(depth, 0)), at = vec2(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w) * size;
    bool hidden = clip.w <= 0.0 || any(lessThan(at, vec2(0.0))) || any(greaterThanEqual(at, size));
    if (!hidden) {
        float farthest = 1.0;
        for (int y = -1; y <= 1; y++)
            for (int x = -1; x <= 1; x++)
                farthest = min(farthest, texelFetch(depth, clamp(ivec2(at) + ivec2(x, y), ivec2(0), ivec2(size) - 1), 0).r);
        hidden = near.z / near.w < farthest;
    }
    if (clip.w <= 0.0)
        at = vec2(-1e4);
    markers[i].place = vec4(at, hidden ? 1.0 : 0.0, 0.0);
}
