// SPDX-License-Identifier: GPL-3.0-or-later
// Bakes light, that is, computes it in advance: the light that reaches each vertex, each large triangle or each texel of the
// ground, from depth maps of many directions.
#include "light.glsl"
#include "shadow.glsl"
#include "environment.glsl"
#include "normal.glsl"
layout(local_size_x = 64) in;
layout(binding = 1) uniform sampler2DArrayShadow sky_maps;
layout(std430, binding = 1) readonly buffer Directions {
    mat4 map_from_plant[32];
    // by sky map (depth map seen from one direction of the sky): unit vector towards that direction; w: brightness of the sky
    // there
    vec4 direction[32];
};
// matrix from the coordinates of the vertices to plant axes, relative to the centre of the scene
layout(location = 0) uniform mat4 plant_from_here;
layout(location = 1) uniform mat4 sun_from_plant;
layout(location = 4) uniform mat3 plant_from_normal;
layout(location = 8) uniform vec4 sun;             // unit vector towards the sun; w: texel size of the sun's depth map in metres
layout(location = 9) uniform float sky_texel_m;
layout(location = 10) uniform ivec2 range; // range of vertices, sample points or texels to compute: first index, and one beyond the last
#ifdef GROUND
const int TAPS = 16;
// radius of the disc that opening() samples in a sky map (depth map for one direction), relative to the map's width
const float SPREAD = 0.05;
layout(rg8, binding = 0) uniform image2D ground; // sun, openness
layout(location = 11) uniform vec3 ground_up;
#else
const int TAPS = 4;
const float SPREAD = 0.004;
layout(std430, binding = 2) readonly buffer Positions { float positions_m[]; };
layout(std430, binding = 3) readonly buffer Normals { uint normals[]; }; // packed as in normal.glsl
// four bytes per vertex: light, ambient light, openness (visible part of the sky), cosine of the angle between normal and sun
layout(std430, binding = 4) buffer Light { uint baked[]; };
layout(std430, binding = 5) readonly buffer Corners { uint corners[]; }; // vertex indices of the corners of large triangles (bake_faces.h)
// three sums per vertex over the samples that look_within() takes in the adjoining large triangles: weights, openness times
// weight, visible fraction of the sun times weight
layout(std430, binding = 6) buffer Sums { uint sums[]; };
layout(location = 12) uniform float large_m;
layout(location = 13) uniform bool has_faces;
// lower bound of openness (0..1); above 0 if assets are hidden, so that surfaces next to them are not dark
layout(location = 14) uniform float least_open;
#endif

const vec2 disc[16] = vec2[](vec2(0.177, 0.000), vec2(-0.226, 0.207), vec2(0.035, -0.394), vec2(0.285, 0.371), vec2(-0.522, -0.092),
                             vec2(0.494, -0.314), vec2(-0.166, 0.615), vec2(-0.316, -0.608), vec2(0.685, 0.249), vec2(-0.712, 0.294),
                             vec2(0.343, -0.734), vec2(0.255, 0.808), vec2(-0.764, -0.443), vec2(0.897, -0.197), vec2(-0.548, 0.779),
                             vec2(-0.126, -0.976));

// Returns the open fraction of a cone around one direction of the sky maps; with only 32 directions, a single ray per direction would be
// too coarse. slope: slope of the surface in the depth map, so that the surface does not occlude itself.
float opening(vec3 p, vec2 slope, int i)
{
    float sum = 0.0;
    for (int k = 0; k < TAPS; k++) {
        vec2 to = disc[k] * SPREAD;
        sum += texture(sky_maps, vec4(p.xy + to, float(i), p.z + dot(slope, to)));
    }
    return sum / float(TAPS);
}

// Returns the fraction (0..1) of the sky and ground in front of the surface that no asset hides, weighted by the brightness of
// a typical sky.
float openness(vec3 place, vec3 normal)
{
    float open = 0.0, all = 0.0;
    vec3 off = place + normal * (1.6 * sky_texel_m);
    for (int i = 0; i < 32; i++) {
        float facing = dot(normal, direction[i].xyz);
        if (facing <= 0.0)
            continue;
        vec3 p = (map_from_plant[i] * vec4(off, 1.0)).xyz, n = mat3(map_from_plant[i]) * normal;
        vec2 slope = clamp(-n.xy / n.z, -12.0, 12.0);
        facing *= direction[i].w;
        open += facing * opening(p, slope, i);
        all += facing;
    }
    return open / max(all, 1e-3);
}

#ifndef GROUND
vec3 vertex_place(uint i)
{
    return (plant_from_here * vec4(positions_m[3 * i], positions_m[3 * i + 1], positions_m[3 * i + 2], 1.0)).xyz;
}

vec3 vertex_normal(uint i)
{
    return normalize(plant_from_normal * unfold_normal(unpackSnorm2x16(normals[i])));
}
#endif

#ifdef FACES
// Computes the light at sample i % 6 of large triangle i / 6 and adds it to the sums of the triangle's corners. Three of the
// six samples are near the corners, three near the middles of the edges.
void look_within(int i)
{
    int k = i % 6, first = i / 6 * 3;
    vec3 part = k < 3 ? vec3(0.15) : vec3(0.45);
    part[k % 3] = k < 3 ? 0.7 : 0.1;
    uvec3 corner = uvec3(corners[first], corners[first + 1], corners[first + 2]);
    mat3 places = mat3(vertex_place(corner.x), vertex_place(corner.y), vertex_place(corner.z));
    vec3 place = places * part, normal = mat3(vertex_normal(corner.x), vertex_normal(corner.y), vertex_normal(corner.z)) * part;
    float size = sqrt(length(cross(places[1] - places[0], places[2] - places[0]))) / large_m;
    normal *= inversesqrt(max(dot(normal, normal), 1e-6));
    float sun_visible = sun_visibility(sun_from_plant, place, normal, sun.w);
#ifdef SKY
    float open = openness(place, normal);
#else
    float open = 0.0;
#endif
    uvec3 weight = uvec3(256.0 * clamp(size, 0.05, 16.0) * part + 0.5);
    for (int c = 0; c < 3; c++) {
        atomicAdd(sums[3u * corner[c]], weight[c]);
        atomicAdd(sums[3u * corner[c] + 1u], uint(float(weight[c]) * open + 0.5));
        atomicAdd(sums[3u * corner[c] + 2u], uint(float(weight[c]) * sun_visible + 0.5));
    }
}
#endif

void main()
{
    int i = range.x + int(gl_GlobalInvocationID.x);
    if (i >= range.y)
        return;
#ifdef GROUND
    ivec2 size = imageSize(ground), at = ivec2(i % size.x, i / size.x);
    vec3 place = (plant_from_here * vec4((vec2(at) + 0.5) / vec2(size), 0.0, 1.0)).xyz;
    float sun_visible = sun_visibility(sun_from_plant, place, ground_up, sun.w);
#ifdef SKY
    float open = openness(place, ground_up);
#else
    float open = imageLoad(ground, at).g;
#endif
    imageStore(ground, at, vec4(sun_visible, open, 0.0, 0.0));
#elif defined(FACES)
    look_within(i);
#else
    vec3 place = vertex_place(uint(i)), normal = vertex_normal(uint(i));
    float weight = has_faces ? float(sums[3 * i]) : 0.0;
#ifdef SKY
    float open = weight > 0.0 ? float(sums[3 * i + 1]) / weight : openness(place, normal);
#else
    float open = unpackUnorm4x8(baked[i]).z;
#endif
    // rounds openness to its 8 stored bits, so that the light does not change when a later bake reads the stored openness
    open = round(max(open, least_open) * 255.0) / 255.0;
    float ambient = open * sky_brightness(normal);
    float facing = max(dot(normal, sun.xyz), 0.0);
    float sun_visible = weight > 0.0 ? float(sums[3 * i + 2]) / weight : sun_visibility(sun_from_plant, place, normal, sun.w);
    baked[i] = packUnorm4x8(vec4(light_scalar(ambient, facing * sun_visible), ambient, open, facing));
#endif
}
