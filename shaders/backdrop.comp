// SPDX-License-Identifier: GPL-3.0-or-later
// The backdrop by height over the horizon, -1 to 1 from left to right; 16 rows that round at different places, one for each pixel of
// a 4x4 tile, so that its slow gradients show no steps. Below them the same of the dark one.
layout(local_size_x = 64) in;
layout(rgba8, binding = 0) writeonly uniform image2D backdrops;

const float bayer[16] = float[](0.0, 8.0, 2.0, 10.0, 12.0, 4.0, 14.0, 6.0, 3.0, 11.0, 1.0, 9.0, 15.0, 7.0, 13.0, 5.0);

// What the picture shows where there is nothing, even and bright: for an operator, not a game. sRGB.
vec3 backdrop(float height, bool dark)
{
    vec3 zenith = vec3(0.757, 0.816, 0.870), horizon = vec3(0.957, 0.963, 0.967), nadir = vec3(0.866, 0.874, 0.880);
    if (dark)
        zenith = vec3(0.090, 0.110, 0.135), horizon = vec3(0.235, 0.255, 0.275), nadir = vec3(0.165, 0.178, 0.190);
    return height > 0.0 ? mix(horizon, zenith, pow(min(height, 1.0), 0.65)) : mix(horizon, nadir, pow(min(-height * 1.6, 1.0), 0.65));
}

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    vec3 c = backdrop((float(at.x) - 1024.0) / 1023.5, at.y >= 16);
    imageStore(backdrops, at, vec4(floor(c * 255.0 + (bayer[at.y & 15] + 0.5) / 16.0) / 255.0, 1.0));
}
