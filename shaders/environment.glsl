// SPDX-License-Identifier: GPL-3.0-or-later
// The surroundings: an even, bright sky over light ground. As a backdrop for an operator, not a game.

// What the picture shows where there is nothing; sRGB.
vec3 backdrop(float height)
{
    const vec3 zenith = vec3(0.757, 0.816, 0.870), horizon = vec3(0.957, 0.963, 0.967), nadir = vec3(0.866, 0.874, 0.880);
    return height > 0.0 ? mix(horizon, zenith, pow(min(height, 1.0), 0.65)) : mix(horizon, nadir, pow(min(-height * 1.6, 1.0), 0.65));
}

// What a surface of that roughness mirrors; linear radiance, 1 = white. height: of the mirrored ray.
vec3 mirrored(float height, float roughness)
{
    const vec3 sky = vec3(0.86, 0.93, 1.00), ground = vec3(0.40, 0.39, 0.38);
    float soft = 0.06 + 0.9 * roughness;
    float above = smoothstep(-soft, soft, height);
    vec3 c = mix(ground, sky, above);
    float band = exp(-pow((height - 0.18) / (0.10 + 0.6 * roughness), 2.0)); // a bright band over the horizon gives metal its shape
    return c * (0.72 + (0.75 - 0.45 * roughness) * band);
}
