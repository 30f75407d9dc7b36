// SPDX-License-Identifier: GPL-3.0-or-later
// The backdrop by height over the horizon, -1 to 1 from left to right.
#include "environment.glsl"
layout(local_size_x = 64) in;
layout(rgba8, binding = 0) writeonly uniform image2D backdrops;

void main()
{
    int x = int(gl_GlobalInvocationID.x);
    imageStore(backdrops, ivec2(x, 0), vec4(backdrop((float(x) - 512.0) / 511.5), 1.0));
}
