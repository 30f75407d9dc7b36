// SPDX-License-Identifier: GPL-3.0-or-later
// The backdrop by height over the horizon, -1 to 1 from left to right; 16 rows that round at different places, one for each pixel of
// a 4x4 tile, so that its slow gradients show no steps.
#include "environment.glsl"
layout(local_size_x = 64) in;
layout(rgba8, binding = 0) writeonly uniform image2D backdrops;

const float bayer[16] = float[](0.0, 8.0, 2.0, 10.0, 12.0, 4.0, 14.0, 6.0, 3.0, 11.0, 1.0, 9.0, 15.0, 7.0, 13.0, 5.0);

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    vec3 c = backdrop((float(at.x) - 1024.0) / 1023.5);
    imageStore(backdrops, at, vec4(floor(c * 255.0 + (bayer[at.y] + 0.5) / 16.0) / 255.0, 1.0));
}
