// SPDX-License-Identifier: GPL-3.0-or-later
// The sensors of one asset's field, which reference.glsl sums at each fragment.
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
    vec4 limits; // x, y: lowest and highest value that the sum may have
    Sensor sensors[];
};
