// SPDX-License-Identifier: GPL-3.0-or-later
// Computes the field at a fragment as a sum over all sensors, for the interpolations `paper` (Algorithm 1 of Kim & Suh) and `shepard`, by
// the rules of server/field/field.h. Geodesic distances are interpolated over the triangle, straight-line ones computed from the fragment's
// position. PIXEL_FIELD: straight-line distances only (field/pixel_field.h).
#include "sensors.glsl"
#ifdef PIXEL_FIELD
#define GRID_ACCESS readonly
#include "sensor_cells.glsl"
// Buffer textures, because fragments read them at different places, which storage buffers make slow in software GL. Texels of the
// buffer Sensors: SENSOR_TEXEL and the next one are the first sensor
layout(binding = 14) uniform usamplerBuffer sensor_texels;
const int SENSOR_TEXEL = 4, LIST_TEXELS = 9 + MOST_NEAR / 8;
// LIST_TEXELS per list. 0 to 8: polynomials that replace sums over the far sensors (struct pixel_list in render/soft/pixel_lists.h) of
// weights, weights times values, and weights of uncertain sensors. Each: coefficients of 1, x, y, z; xx, yy, zz, -; xy, xz, yz, -. x, y, z
// are metres from the cell's centre. All are multiplied by 2^-top; top is the last number of texel 1. Last number of texel 2:
// number of near sensors; -1: the cell has no list. From texel 9 on: indices of near sensors in `sensors`, two per number, the
// first one in the lower half
layout(binding = 16) uniform usamplerBuffer list_texels;
#endif
#if defined(PIXEL_FIELD) && defined(REFINED)
layout(location = 7) centroid in vec3 interpolated_place;
#else
layout(location = 7) in vec3 interpolated_place;
#endif
// the constant 1 as the GL driver interpolates it to the centroid of the covered samples; dividing by it corrects the driver's error
#ifndef CENTROID_ONE
#define CENTROID_ONE 1.0
#endif

const float FAR = 1e30, LN_2 = 0.69314718;

#ifndef PIXEL_FIELD
layout(std430, binding = 6) readonly buffer Corners { uint corners[]; };
layout(std430, binding = 7) readonly buffer Positions { float positions_m[]; };
layout(binding = 14) uniform samplerBuffer distances; // geodesic distances in metres; four sensors per texel, [sensor / 4][vertex]
layout(location = 8) uniform int first_triangle;

vec3 corner_place(uint vertex)
{
    return vec3(positions_m[3 * vertex], positions_m[3 * vertex + 1], positions_m[3 * vertex + 2]);
}

// Returns the fragment's barycentric weights in its triangle.
vec3 parts_of(uvec3 corner, vec3 file_place)
{
    vec3 a = corner_place(corner.x), b = corner_place(corner.y) - a, c = corner_place(corner.z) - a, p = file_place - a;
    float bb = dot(b, b), bc = dot(b, c), cc = dot(c, c), pb = dot(p, b), pc = dot(p, c), area = bb * cc - bc * bc;
    if (!(area > 0.0))
        return vec3(1.0, 0.0, 0.0);
    float v = (cc * pb - bc * pc) / area, w = (bb * pc - bc * pb) / area;
    return vec3(1.0 - v - w, v, w);
}

float along_surface(uint column, uvec3 corner, vec3 part)
{
    int first = int(column / 4u) * int(more.y), lane = int(column & 3u);
    vec3 d = vec3(texelFetch(distances, first + int(corner.x))[lane], texelFetch(distances, first + int(corner.y))[lane],
                  texelFetch(distances, first + int(corner.z))[lane]);
    return max(d.x, max(d.y, d.z)) < FAR ? max(dot(d, part), 0.0) : FAR;
}

#endif

struct Spot {
    vec3 place, part;
    uvec3 corner;
    int list;         // index of the list of the place's cell; -1: it has none, so that all sensors are summed
    int near_count;   // number of near sensors in the list
    float top;        // of the list's polynomials
    bool skips;       // all sensors need not be summed, because the invocation only helps its neighbours
    vec3 from_centre; // vector from the centre of the cell, in metres
};

#ifdef PIXEL_FIELD
vec4 list_texel(int list, int i)
{
    return uintBitsToFloat(texelFetch(list_texels, list * LIST_TEXELS + i));
}

void find_list(inout Spot spot)
{
    vec3 at = (spot.place - grid_corner_m.xyz) / grid_corner_m.w, cell = floor(at);
    if (!(all(greaterThanEqual(cell, vec3(0.0))) && all(lessThan(cell, vec3(grid_cells.xyz))))) // also for NaN
        return;
    int number = int((cell.z * float(grid_cells.y) + cell.y) * float(grid_cells.x) + cell.x), list = int(grid_lists[number]) - 1;
    if (list < 0)
        return;
    spot.near_count = min(int(list_texel(list, 2).w), MOST_NEAR);
    spot.top = list_texel(list, 1).w;
    spot.list = spot.near_count >= 0 ? list : -1;
    spot.from_centre = grid_corner_m.w * (at - cell - 0.5);
}
#endif

// Returns the number of sensors that are summed one by one: the near ones of the list, or all.
int sensor_count(Spot spot)
{
    return spot.list >= 0 ? spot.near_count : spot.skips ? 0 : sensors.length();
}

// Returns the i-th of these sensors.
Sensor sensor_of(Spot spot, int i)
{
#ifdef PIXEL_FIELD
    if (spot.list >= 0)
        i = int(texelFetch(list_texels, spot.list * LIST_TEXELS + 9 + (i >> 3))[i >> 1 & 3] >> (16 * (i & 1)) & 0xffffu);
    uvec4 first = texelFetch(sensor_texels, SENSOR_TEXEL + 2 * i), second = texelFetch(sensor_texels, SENSOR_TEXEL + 2 * i + 1);
    return Sensor(uintBitsToFloat(first), uintBitsToFloat(second.x), uintBitsToFloat(second.y), 0u, second.w);
#else
    return sensors[i];
#endif
}

Spot spot_here()
{
    Spot spot = Spot(interpolated_place / CENTROID_ONE, vec3(0.0), uvec3(0), -1, 0, 0.0, false, vec3(0.0));
#ifdef PIXEL_FIELD
    find_list(spot);
#ifndef RICH // isolines need the values of all invocations
    // places beyond a triangle's edge often have no list, and would delay their neighbours by the sum over all sensors
    spot.skips = gl_HelperInvocation && spot.list < 0;
#endif
#else
    int triangle = first_triangle + gl_PrimitiveID;
    spot.corner = uvec3(corners[3 * triangle], corners[3 * triangle + 1], corners[3 * triangle + 2]);
    spot.part = parts_of(spot.corner, spot.place);
#endif
    return spot;
}

float distance_to(Sensor sensor, Spot spot)
{
#ifndef PIXEL_FIELD
    if (choice.y != 0)
        return along_surface(sensor.column, spot.corner, spot.part);
#endif
    return distance(spot.place, sensor.place_m.xyz);
}

float nearness(float distance_m)
{
    return max(0.0, 1.0 - distance_m / numbers.y);
}

// Returns the factor that reduces a sensor's weight towards its reach (maximum distance of influence): 1 at the nearest
// sensor's distance, 0 beyond the reach.
float faded(float distance_m, float near_m)
{
    float left = isinf(numbers.z) || distance_m <= near_m ? 1.0 : max(0.0, numbers.z - distance_m) / (numbers.z - near_m);
    return left * left;
}

// Distances in metres from the fragment to the nearest usable sensor, to the nearest lost one, and to the nearest one without alarm
// limits. FAR: no such sensor.
struct Nearest {
    float usable_m, lost_m, no_limits_m;
};

// Sums over all usable sensors: weight times value, weight, and weight of sensors of quality Uncertain.
struct Sums {
    float values, weights, marked;
};

Nearest nearest_sensors(Spot spot, int count)
{
    Nearest nearest = Nearest(FAR, FAR, FAR);
    for (int n = 0; n < count; n++) {
        Sensor sensor = sensor_of(spot, n);
        if ((sensor.state & 1u) == 0u)
            continue;
        float d = distance_to(sensor, spot);
        if ((sensor.state & 2u) != 0u)
            nearest.usable_m = min(nearest.usable_m, d);
        else if ((sensor.state & 8u) != 0u)
            nearest.no_limits_m = min(nearest.no_limits_m, d);
        else
            nearest.lost_m = min(nearest.lost_m, d);
    }
    return nearest;
}

#ifdef PIXEL_FIELD
float polynomial(Spot spot, int texel)
{
    vec4 slope = list_texel(spot.list, texel);
    vec3 u = spot.from_centre, squares = list_texel(spot.list, texel + 1).xyz, mixed = list_texel(spot.list, texel + 2).xyz;
    return slope.x + dot(slope.yzw, u) + dot(squares, u * u) + dot(mixed, u.xxy * u.yzz);
}

// Adds the polynomials of the list to the sums. part: factor that converts them to the unit of the weights here.
void add_far(Spot spot, float near_m, float part, inout Sums sums)
{
    float left = isinf(numbers.z) ? 1.0 : 1.0 - near_m / numbers.z;
    if (near_m >= FAR || left < 1e-6)
        return;
    part /= left * left;
    sums.weights += part * polynomial(spot, 0);
    sums.values += part * polynomial(spot, 3);
    sums.marked += part * polynomial(spot, 6);
}
#endif

Sums sums_of(Spot spot, float near_m, int count)
{
    float limit_m = min(max(near_m, numbers.z), 0.5 * FAR), top = 0.0;
    // computes `top`, the largest exponent of all sensors; Algorithm 1 subtracts it from all exponents, so that weights do not overflow
    int count_of_top = choice.x != 0 ? count : 0;
    for (int n = 0; n < count_of_top; n++) {
        Sensor sensor = sensor_of(spot, n);
        float d = distance_to(sensor, spot);
        if ((sensor.state & 2u) != 0u && d <= limit_m)
            top = max(top, nearness(d) * sensor.place_m.w);
    }
    Sums sums = Sums(0.0, 0.0, 0.0);
#ifdef PIXEL_FIELD
    if (spot.list >= 0) {
        top = max(top, choice.x != 0 ? LN_2 * spot.top : 0.0);
        add_far(spot, near_m, choice.x != 0 ? exp(LN_2 * spot.top - top) : exp2(numbers.x * log2(max(near_m, 1e-30)) + spot.top), sums);
    }
#endif
    for (int n = 0; n < count; n++) {
        Sensor sensor = sensor_of(spot, n);
        float d = distance_to(sensor, spot), strength = sensor.place_m.w;
        if ((sensor.state & 2u) == 0u || d > limit_m)
            continue;
        float near = nearness(d);
        float weight = choice.x != 0 ? exp(near * strength - top) : d <= near_m ? strength : strength * pow(near_m / d, numbers.x);
        weight *= faded(d, near_m);
        sums.values += sensor.value * weight * (choice.x != 0 && sensor.decay > 0.0 ? pow(near, sensor.decay) : 1.0);
        sums.weights += weight;
        sums.marked += (sensor.state & 4u) != 0u ? weight : 0.0;
    }
    return sums;
}

#ifdef PIXEL_FIELD
struct InverseSquares {
    vec3 nearest; // squared distances to the nearest usable, lost and no-limits sensor
    Sums sums;
};

void add_usable(Sensor sensor, vec3 place, inout InverseSquares to)
{
    vec3 away = place - sensor.place_m.xyz;
    float square = dot(away, away), weight = sensor.place_m.w / max(square, 1e-24);
    to.nearest.x = min(to.nearest.x, square);
    to.sums.values += sensor.value * weight;
    to.sums.weights += weight;
    to.sums.marked += (sensor.state & 4u) != 0u ? weight : 0.0;
}

void add_unusable(Sensor sensor, vec3 place, inout InverseSquares to)
{
    vec3 away = place - sensor.place_m.xyz;
    float square = dot(away, away);
    if ((sensor.state & 8u) != 0u)
        to.nearest.z = min(to.nearest.z, square);
    else
        to.nearest.y = min(to.nearest.y, square);
}

// Finds the nearest sensors and computes the sums in one pass over the sensors, for weights of strength / distance^2. Sums no sensor if
// `applies` is false.
Nearest inverse_square_sums(Spot spot, bool applies, out Sums sums)
{
    applies = applies && !spot.skips;
    bool listed = spot.list >= 0;
    int near = applies && listed ? spot.near_count : 0, usable = applies && !listed ? int(more.y) : 0;
    int all = applies && !listed ? sensors.length() : 0;
    InverseSquares to = InverseSquares(vec3(FAR), Sums(0.0, 0.0, 0.0));
    for (int n = 0; n < near; n++) {
        Sensor sensor = sensor_of(spot, n);
        if ((sensor.state & 2u) != 0u)
            add_usable(sensor, spot.place, to);
        else
            add_unusable(sensor, spot.place, to);
    }
    for (int i = 0; i < usable; i++)
        add_usable(sensors[i], spot.place, to);
    for (int i = usable; i < all; i++)
        add_unusable(sensors[i], spot.place, to);
    if (applies && listed)
        add_far(spot, 0.0, exp2(spot.top), to.sums);
    sums = to.sums;
    return Nearest(to.nearest.x < FAR ? sqrt(to.nearest.x) : FAR, to.nearest.y < FAR ? sqrt(to.nearest.y) : FAR,
                   to.nearest.z < FAR ? sqrt(to.nearest.z) : FAR);
}
#endif

// Returns the value interpolated between sensors at the fragment, and flags. x: value; y, z, w: 1 if it has no data, is
// uncertain, has no alarm limits; else 0.
vec4 reference_field()
{
    Spot spot = spot_here();
    Sums sums;
    int count = sensor_count(spot);
#ifdef PIXEL_FIELD
    // A loop that is not needed has 0 steps, because software GL runs the loops on both sides of a branch.
    bool inverse_square = choice.x == 0 && numbers.x == 2.0 && isinf(numbers.z);
    Nearest nearest = inverse_square_sums(spot, inverse_square, sums);
    count = inverse_square ? 0 : count;
    if (!inverse_square)
        nearest = nearest_sensors(spot, count);
#else
    Nearest nearest = nearest_sensors(spot, count);
#endif
    float near_m = nearest.usable_m, lost_m = nearest.lost_m, no_limits_m = nearest.no_limits_m;
    if (choice.w == 1)
        return vec4(near_m, near_m < FAR ? 0.0 : 1.0, 0.0, 0.0);
    bool reached = near_m < FAR && near_m <= numbers.z;
#ifdef PIXEL_FIELD
    if (!inverse_square)
#endif
        sums = sums_of(spot, near_m, count);
    bool lost = lost_m < near_m, filled = reached && lost && choice.z != 0;
    bool no_limits = no_limits_m < near_m && no_limits_m <= lost_m && no_limits_m <= numbers.z;
    bool no_data = !no_limits && !(reached && (!lost || filled));
    bool uncertain = filled || (sums.marked > 0.0 && 2.0 * sums.marked >= sums.weights);
    float value = sums.weights > 0.0 ? sums.values / sums.weights : 0.0;
    if (choice.x != 0)
        value = value * more.x + (sums.weights > 0.0 ? numbers.w : 0.0);
    // polynomials may exceed the readings slightly
    value = sums.weights > 0.0 ? clamp(value, limits.x, limits.y) : numbers.w;
    if (choice.w == 5) {
        float far = min(near_m, 1e6 * more.z) / more.z;
        value = min(more.w * exp(min(0.5 * far * far, 80.0)), numbers.w);
        uncertain = false;
    }
    return vec4(value, no_data ? 1.0 : 0.0, uncertain ? 1.0 : 0.0, no_limits ? 1.0 : 0.0);
}
