// SPDX-License-Identifier: GPL-3.0-or-later
// Computes the field at a fragment as a sum over all sensors, for the interpolations `paper` (Algorithm 1 of Kim & Suh) and `shepard`, by
// the rules of server/field/field.h. Geodesic distances are interpolated over the triangle, straight-line ones computed from the fragment's
// position. PIXEL_FIELD: straight-line distances only (field/pixel_field.h).
struct Sensor {
    vec4 place_m;  // position of the sensor in coordinates of the asset file; w: strength (factor on the sensor's weight)
    float decay, value;
    // column: index of the sensor in `distances`; state, as bits: 1: configured, 2: usable, 4: uncertain, 8: without limits
    uint column, state;
};
layout(std430, binding = 5) readonly buffer Sensors {
    // x: exponent of interpolation shepard; y: radius in metres of Algorithm 1; z: reach in metres, the distance beyond which a
    // sensor has no influence; w: lower end MIN of the group's range, or the largest value that a hot spot may have
    vec4 numbers;
    // x: factor MAX - MIN of the range, which scales Algorithm 1's sum to a value, or 0; y: vertex count of the asset, or with
    // PIXEL_FIELD the number of usable sensors, which are the first ones in `sensors`; z, w (only if the smallest visible hot
    // spot is shown): size of a hot spot and the value at which it is seen
    vec4 more;
    // x: 1: Algorithm 1, 0: shepard; y: 1: geodesic distances; z: 1: areas around lost sensors are filled in; w: what is shown (1:
    // distance, 5: hot spot)
    ivec4 choice;
    Sensor sensors[];
};
#if defined(PIXEL_FIELD) && defined(REFINED)
layout(location = 7) centroid in vec3 interpolated_place;
#else
layout(location = 7) in vec3 interpolated_place;
#endif
// the constant 1 as the GL driver interpolates it to the centroid of the covered samples; dividing by it corrects the driver's error
#ifndef CENTROID_ONE
#define CENTROID_ONE 1.0
#endif

const float FAR = 1e30;

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
};

Spot spot_here()
{
    Spot spot = Spot(interpolated_place / CENTROID_ONE, vec3(0.0), uvec3(0));
#ifndef PIXEL_FIELD
    int triangle = first_triangle + gl_PrimitiveID;
    spot.corner = uvec3(corners[3 * triangle], corners[3 * triangle + 1], corners[3 * triangle + 2]);
    spot.part = parts_of(spot.corner, spot.place);
#endif
    return spot;
}

float distance_to(int i, Spot spot)
{
#ifndef PIXEL_FIELD
    if (choice.y != 0)
        return along_surface(sensors[i].column, spot.corner, spot.part);
#endif
    return distance(spot.place, sensors[i].place_m.xyz);
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

Nearest nearest_sensors(Spot spot)
{
    Nearest nearest = Nearest(FAR, FAR, FAR);
    for (int i = 0; i < sensors.length(); i++) {
        if ((sensors[i].state & 1u) == 0u)
            continue;
        float d = distance_to(i, spot);
        if ((sensors[i].state & 2u) != 0u)
            nearest.usable_m = min(nearest.usable_m, d);
        else if ((sensors[i].state & 8u) != 0u)
            nearest.no_limits_m = min(nearest.no_limits_m, d);
        else
            nearest.lost_m = min(nearest.lost_m, d);
    }
    return nearest;
}

Sums sums_of(Spot spot, float near_m)
{
    float limit_m = min(max(near_m, numbers.z), 0.5 * FAR), top = 0.0;
    // computes `top`, the largest exponent of all sensors; Algorithm 1 subtracts it from all exponents, so that weights do not overflow
    for (int i = 0; choice.x != 0 && i < sensors.length(); i++) {
        float d = distance_to(i, spot);
        if ((sensors[i].state & 2u) != 0u && d <= limit_m)
            top = max(top, nearness(d) * sensors[i].place_m.w);
    }
    Sums sums = Sums(0.0, 0.0, 0.0);
    for (int i = 0; i < sensors.length(); i++) {
        float d = distance_to(i, spot), strength = sensors[i].place_m.w;
        if ((sensors[i].state & 2u) == 0u || d > limit_m)
            continue;
        float near = nearness(d);
        float weight = choice.x != 0 ? exp(near * strength - top) : d <= near_m ? strength : strength * pow(near_m / d, numbers.x);
        weight *= faded(d, near_m);
        sums.values += sensors[i].value * weight * (choice.x != 0 && sensors[i].decay > 0.0 ? pow(near, sensors[i].decay) : 1.0);
        sums.weights += weight;
        sums.marked += (sensors[i].state & 4u) != 0u ? weight : 0.0;
    }
    return sums;
}

#ifdef PIXEL_FIELD
// Finds the nearest sensors and computes the sums in one pass over all sensors, for weights of strength / distance^2.
Nearest inverse_square_sums(vec3 place, out Sums sums)
{
    vec3 squares = vec3(FAR); // squared distances to the usable, lost and no-limits sensor nearest to the fragment
    sums = Sums(0.0, 0.0, 0.0);
    int usable = int(more.y);
    for (int i = 0; i < usable; i++) {
        Sensor sensor = sensors[i];
        vec3 away = place - sensor.place_m.xyz;
        float square = dot(away, away), weight = sensor.place_m.w / max(square, 1e-24);
        squares.x = min(squares.x, square);
        sums.values += sensor.value * weight;
        sums.weights += weight;
        sums.marked += (sensor.state & 4u) != 0u ? weight : 0.0;
    }
    for (int i = usable; i < sensors.length(); i++) {
        vec3 away = place - sensors[i].place_m.xyz;
        if ((sensors[i].state & 8u) != 0u)
            squares.z = min(squares.z, dot(away, away));
        else
            squares.y = min(squares.y, dot(away, away));
    }
    return Nearest(squares.x < FAR ? sqrt(squares.x) : FAR, squares.y < FAR ? sqrt(squares.y) : FAR,
                   squares.z < FAR ? sqrt(squares.z) : FAR);
}
#endif

// Returns the value interpolated between sensors at the fragment, and flags. x: value; y, z, w: 1 if it has no data, is
// uncertain, has no alarm limits; else 0.
vec4 reference_field()
{
    Spot spot = spot_here();
    Nearest nearest;
    Sums sums = Sums(0.0, 0.0, 0.0);
#ifdef PIXEL_FIELD
    bool inverse_square = choice.x == 0 && numbers.x == 2.0 && isinf(numbers.z);
    if (inverse_square)
        nearest = inverse_square_sums(spot.place, sums);
    else
#endif
        nearest = nearest_sensors(spot);
    float near_m = nearest.usable_m, lost_m = nearest.lost_m, no_limits_m = nearest.no_limits_m;
    if (choice.w == 1)
        return vec4(near_m, near_m < FAR ? 0.0 : 1.0, 0.0, 0.0);
    bool reached = near_m < FAR && near_m <= numbers.z;
#ifdef PIXEL_FIELD
    if (!inverse_square)
#endif
        sums = sums_of(spot, near_m);
    bool lost = lost_m < near_m, filled = reached && lost && choice.z != 0;
    bool no_limits = no_limits_m < near_m && no_limits_m <= lost_m && no_limits_m <= numbers.z;
    bool no_data = !no_limits && !(reached && (!lost || filled));
    bool uncertain = filled || (sums.marked > 0.0 && 2.0 * sums.marked >= sums.weights);
    float value = sums.weights > 0.0 ? sums.values / sums.weights : 0.0;
    if (choice.x != 0)
        value = value * more.x + (sums.weights > 0.0 ? numbers.w : 0.0);
    value = sums.weights > 0.0 ? value : numbers.w;
    if (choice.w == 5) {
        float far = min(near_m, 1e6 * more.z) / more.z;
        value = min(more.w * exp(min(0.5 * far * far, 80.0)), numbers.w);
        uncertain = false;
    }
    return vec4(value, no_data ? 1.0 : 0.0, uncertain ? 1.0 : 0.0, no_limits ? 1.0 : 0.0);
}
