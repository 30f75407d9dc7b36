// SPDX-License-Identifier: GPL-3.0-or-later
// Makes lists of near sensors by cell of space (sensor_cells.glsl). MARK: finds the cells through which the triangles of an asset pass,
// and gives a list to each of these cells. Otherwise: fills a list in each workgroup, by the method of server/render/soft/pixel_lists.c, which
// explains it; functions with the same name do the same.
#ifdef MARK
#define GRID_ACCESS
#include "sensor_cells.glsl"
layout(local_size_x = 64) in;
layout(std430, binding = 3) readonly buffer Positions { float positions_m[]; };
layout(std430, binding = 4) readonly buffer Corners { uint corners[]; };
layout(location = 0) uniform int triangle_count;
layout(location = 1) uniform int most_lists;
const float SLACK = 1e-3; // in sides of a cell

void give_list(ivec3 cell)
{
    int number = (cell.z * grid_cells.y + cell.y) * grid_cells.x + cell.x;
    if (grid_lists[number] != 0u || atomicCompSwap(grid_lists[number], 0u, ~0u) != 0u)
        return;
    int list = atomicAdd(grid_cells.w, 1);
    grid_lists[number] = list < most_lists ? uint(list) + 1u : 0u;
    if (list < most_lists)
        grid_lists[grid_cells.x * grid_cells.y * grid_cells.z + list] = uint(number);
}

// Returns whether a square with sides of 1 around `middle` lies on the outer side of a triangle's edge. turn: 1 if the corners are in
// counterclockwise order, else -1.
bool is_beyond(vec2 from, vec2 to, vec2 middle, float turn)
{
    vec2 edge = to - from, away = middle - from;
    return turn * (edge.x * away.y - edge.y * away.x) < -0.51 * (abs(edge.x) + abs(edge.y));
}

// Gives a list to each cell that the triangle a, b, c touches. Unit of coordinates: side of a cell. For each column of cells along the
// axis k, which is the nearest to the triangle's normal, the heights of the triangle's plane over the column select the cells.
void give_lists(vec3 a, vec3 b, vec3 c)
{
    vec3 low = min(a, min(b, c)), high = max(a, max(b, c)), normal = cross(b - a, c - a), steep = abs(normal);
    ivec3 first = clamp(ivec3(floor(low - SLACK)), ivec3(0), grid_cells.xyz - 1);
    ivec3 last = clamp(ivec3(floor(high + SLACK)), ivec3(0), grid_cells.xyz - 1);
    int k = steep.x > steep.y ? (steep.x > steep.z ? 0 : 2) : (steep.y > steep.z ? 1 : 2), i = (k + 1) % 3, j = (k + 2) % 3;
    bool flat_one = !(steep[k] > 0.0);
    vec2 a2 = vec2(a[i], a[j]), b2 = vec2(b[i], b[j]), c2 = vec2(c[i], c[j]);
    for (int u = first[i]; u <= last[i]; u++)
        for (int v = first[j]; v <= last[j]; v++) {
            vec2 middle = vec2(u, v) + 0.5;
            ivec3 cell;
            cell[i] = u;
            cell[j] = v;
            int from = first[k], to = last[k];
            if (!flat_one) {
                float turn = sign(normal[k]), height = a[k] - (normal[i] * (middle.x - a2.x) + normal[j] * (middle.y - a2.y)) / normal[k];
                float half_range = 0.5 * (steep[i] + steep[j]) / steep[k] + SLACK;
                if (is_beyond(a2, b2, middle, turn) || is_beyond(b2, c2, middle, turn) || is_beyond(c2, a2, middle, turn))
                    continue;
                from = max(from, int(floor(height - half_range)));
                to = min(to, int(floor(height + half_range)));
            }
            for (cell[k] = from; cell[k] <= to; cell[k]++)
                give_list(cell);
        }
}

vec3 corner_place(int corner)
{
    uint at = 3u * corners[corner];
    return (vec3(positions_m[at], positions_m[at + 1u], positions_m[at + 2u]) - grid_corner_m.xyz) / grid_corner_m.w;
}

void main()
{
    for (int i = int(gl_GlobalInvocationID.x); i < triangle_count; i += int(gl_NumWorkGroups.x * gl_WorkGroupSize.x))
        give_lists(corner_place(3 * i), corner_place(3 * i + 1), corner_place(3 * i + 2));
}
#else
#define GRID_ACCESS readonly
#include "sensors.glsl"
#include "sensor_cells.glsl"
// TEAM: invocations that make a list together; COLUMNS: most numbers that they sum at once
const int TEAM = 32, COLUMNS = 30, LIST_WORDS = 36 + MOST_NEAR / 2;
layout(local_size_x = 32) in;
layout(std430, binding = 7) writeonly buffer Lists { uint words[]; }; // LIST_WORDS per list, as list_texels in reference.glsl
// x, y: middle of the readings, and factor for readings away from it (struct building in pixel_lists.c); z: error that the
// polynomials may cause, as a fraction of the sum of all weights
layout(location = 0) uniform vec3 budget;
const float FAR_M = 1e15, NEVER = 1e30, LOG2_E = 1.44269504;
const uint USABLE = 2u, UNCERTAIN = 4u, NO_LIMITS = 8u;

shared float room[COLUMNS * (TEAM + 1)], result[COLUMNS];
shared float errors[MOST_SENSORS]; // by sensor: as building->errors in pixel_lists.c, with NEVER for INFINITY
shared uint near_bits[MOST_SENSORS / 32], near[MOST_NEAR], threshold;

bool paper, reaches, inverse_square;
int id, count;
vec3 centre_m;
float radius_m;

// Sums the numbers of all invocations in room, or with `least` finds their minima, for the given number of columns, into result.
void collect(int columns, bool least)
{
    barrier();
    if (id < columns) {
        float x = room[id * (TEAM + 1)];
        for (int k = 1; k < TEAM; k++) {
            float other = room[id * (TEAM + 1) + k];
            x = least ? min(x, other) : x + other;
        }
        result[id] = x;
    }
    barrier();
}

void put(int column, float x)
{
    room[column * (TEAM + 1) + id] = x;
}

// --- weights as functions of the distance

float weight_at(Sensor of, float distance_m, bool term, float top)
{
    float exponent;
    bool none = false;
    if (paper) {
        float near = max((numbers.y - distance_m) / numbers.y, 0.0);
        exponent = near * of.place_m.w * LOG2_E;
        if (term && of.decay > 0.0) {
            exponent += of.decay * log2(max(near, 1e-30));
            none = near <= 1e-30;
        }
    } else {
        exponent = -numbers.x * log2(max(distance_m, 1e-30));
    }
    if (reaches) {
        exponent += 2.0 * log2(max(1.0 - distance_m / numbers.z, 1e-30));
        none = none || distance_m >= numbers.z;
    }
    float weight = none ? 0.0 : exp2(min(exponent - top, 100.0));
    return paper ? weight : weight * of.place_m.w;
}

struct Jet {
    float value, first, second, tilt, error, least;
};

Jet inverse_square_jet(Sensor of, float distance_m, float top)
{
    float over = 1.0 / max(distance_m, 1e-12), last = 1.0 / (distance_m + radius_m), q = min(radius_m * over, 0.999);
    float strength = of.place_m.w * exp2(-top), value = strength * over * over, q2 = q * q, left = 1.0 / (1.0 - q);
    Jet jet;
    jet.value = value - value * q2 * q2;
    jet.first = -2.0 * value * over;
    jet.second = value * over * over * (6.0 + 8.0 * q2);
    jet.tilt = jet.first * q2;
    jet.error = value * q2 * q * (2.0 + 2.0 * q + q2 * (6.0 - 5.0 * q) * left * left);
    jet.least = strength * last * last;
    return jet;
}

// x, y, z: first, second and third derivative
void add_pole(inout vec3 to, float times, float left)
{
    float over = 1.0 / left;
    to += times * vec3(over, over * over, 2.0 * over * over * over);
}

vec3 logarithm_of(Sensor of, float near_m, float far_m, bool term, float sign_of_second)
{
    vec3 outer = vec3(0.0), back = vec3(0.0);
    if (paper) {
        if (near_m < numbers.y) {
            if (term)
                add_pole(back, of.decay, numbers.y - far_m);
            outer.x = of.place_m.w / numbers.y + back.x;
            back.x = 0.0;
        }
    } else {
        add_pole(outer, numbers.x, near_m);
    }
    if (reaches) {
        vec3 reach = vec3(0.0);
        add_pole(reach, 2.0, numbers.z - far_m);
        outer.x += reach.x;
        back.yz += reach.yz;
    }
    return outer + vec3(0.0, sign_of_second * back.y, back.z);
}

Jet jet_of(Sensor of, float distance_m, bool term, float top)
{
    if (inverse_square)
        return inverse_square_jet(of, distance_m, top);
    float near_m = max(distance_m - radius_m, 0.0), far_m = distance_m + radius_m;
    float most = weight_at(of, near_m, term, top), least = weight_at(of, far_m, term, top), middle = 0.5 * (most + least);
    Jet jet = Jet(middle, 0.0, 0.0, 0.0, most - middle, least);
    bool smooth_here = near_m > 1e-12 && (!paper || far_m < numbers.y || near_m >= numbers.y) && (!reaches || far_m < numbers.z);
    if (!smooth_here)
        return jet;
    vec3 bound = logarithm_of(of, near_m, far_m, term, 1.0), here = logarithm_of(of, distance_m, distance_m, term, -1.0);
    float over = 1.0 / near_m, p1 = bound.x, along = p1 * p1 * p1 + 3.0 * p1 * bound.y + bound.z;
    float across = 3.0 * over * (p1 * p1 + bound.y + p1 * over);
    float error = most * (radius_m * radius_m * radius_m / 6.0) * max(along, across);
    if (!(error < most - middle))
        return jet;
    float value = weight_at(of, distance_m, term, top);
    return Jet(value, -value * here.x, value * (here.x * here.x + here.y), 0.0, error, least);
}

// --- polynomials

struct Polynomial { // coefficients of 1; x, y, z; xx, yy, zz; xy, xz, yz
    float constant;
    vec3 slope, squares, mixed;
};

void add_terms(inout Polynomial to, Jet jet, float times, float distance_m, vec3 away)
{
    float first = times * jet.first, bend = first / max(distance_m, 1e-12), second = 0.5 * (times * jet.second - bend);
    to.constant += times * jet.value;
    to.slope += (first + times * jet.tilt) * away;
    to.squares += second * away * away + 0.5 * bend;
    to.mixed += 2.0 * second * away.xxy * away.yzz;
}

void put_polynomial(int column, Polynomial of)
{
    put(column, of.constant);
    for (int c = 0; c < 3; c++) {
        put(column + 1 + c, of.slope[c]);
        put(column + 4 + c, of.squares[c]);
        put(column + 7 + c, of.mixed[c]);
    }
}

// --- choosing

vec3 away_from(Sensor of, out float distance_m)
{
    vec3 away = centre_m - of.place_m.xyz;
    distance_m = length(away);
    return away / max(distance_m, 1e-12);
}

// Returns upper bounds of the distance from any point of the cell to the nearest sensor that is used, lost, or has no limits (x, y, z);
// w: as `top` in struct nearest_bounds.
vec4 bound_nearest()
{
    vec3 bounds = vec3(FAR_M);
    float top = 0.0;
    for (int i = id; i < count; i += TEAM) {
        Sensor of = sensors[i];
        float distance_m;
        away_from(of, distance_m);
        float far_m = distance_m + radius_m;
        if ((of.state & USABLE) != 0u) {
            bounds.x = min(bounds.x, far_m);
            top = max(top, paper ? of.place_m.w * LOG2_E * (1.0 - distance_m / numbers.y) : 0.0);
        } else if ((of.state & NO_LIMITS) != 0u) {
            bounds.z = min(bounds.z, far_m);
        } else {
            bounds.y = min(bounds.y, far_m);
        }
    }
    for (int c = 0; c < 3; c++)
        put(c, bounds[c]);
    put(3, -top);
    collect(4, true);
    bounds = vec3(result[0], result[1], result[2]);
    return vec4(bounds, paper ? -result[3] : -numbers.x * log2(bounds.x));
}

// Returns a lower bound of the sum of all weights in the cell.
float bound_errors(vec4 nearest)
{
    float lost_m = min(nearest.x, nearest.y), no_limits_m = min(nearest.x, nearest.z), top = nearest.w;
    float least = 0.0, weights = 0.0, by_distance = 0.0;
    vec3 along = vec3(0.0);
    for (int i = id; i < count; i += TEAM) {
        Sensor of = sensors[i];
        float distance_m;
        vec3 away = away_from(of, distance_m);
        float near_m = distance_m - radius_m;
        if ((of.state & USABLE) == 0u) {
            errors[i] = near_m <= ((of.state & NO_LIMITS) != 0u ? no_limits_m : lost_m) ? NEVER : -1.0;
            continue;
        }
        Jet jet = jet_of(of, distance_m, false, top);
        float error = jet.error + (paper ? jet_of(of, distance_m, true, top).error : 0.0);
        if (!paper)
            error *= 0.5 + budget.y * abs(of.value - budget.x);
        errors[i] = near_m > nearest.x && error < FAR_M ? error : NEVER;
        least += jet.least;
        if (inverse_square) { // add_at_centre()
            float over = 1.0 / max(distance_m, 0.01 * radius_m), q = radius_m * over;
            float weight = of.place_m.w * exp2(-top) * over * over;
            weights += weight;
            by_distance += weight * q * q;
            along += weight * q * (distance_m * over) * away;
        }
    }
    put(0, least);
    put(1, weights);
    put(2, by_distance);
    for (int c = 0; c < 3; c++)
        put(3 + c, along[c]);
    collect(6, false);
    float by_centre = result[1] > 0.0 ? result[1] * result[1] /
                                            (result[1] + 2.0 * length(vec3(result[3], result[4], result[5])) + result[2])
                                      : 0.0;
    return max(result[0], by_centre);
}

// Returns the largest error of a sensor that a polynomial replaces, so that the errors of all of these add up to at most `allowed`.
// Each invocation tries one limit.
float choose_limit(float allowed)
{
    float limit = allowed * exp2(-0.5 * float(id)), sum = 0.0;
    if (id == 0)
        threshold = uint(TEAM);
    barrier();
    for (int i = 0; i < count; i++)
        sum += errors[i] <= limit ? max(errors[i], 0.0) : 0.0;
    if (sum <= allowed)
        atomicMin(threshold, uint(id));
    barrier();
    return threshold < uint(TEAM) ? allowed * exp2(-0.5 * float(threshold)) : 0.0;
}

// Writes the indices of all sensors with an error above the limit to `near`, in ascending order, and returns their number. If they are
// more than MOST_NEAR, writes only the first ones.
int find_near(float limit)
{
    int batches = (count + TEAM - 1) / TEAM, found = 0;
    for (int b = id; b < batches; b += TEAM)
        near_bits[b] = 0u;
    barrier();
    for (int i = id; i < count; i += TEAM)
        if (errors[i] > limit)
            atomicOr(near_bits[i / TEAM], 1u << id);
    barrier();
    for (int b = 0; b < batches; b++) {
        uint bits = near_bits[b];
        int at = found + bitCount(bits & ((1u << id) - 1u));
        if ((bits >> id & 1u) != 0u && at < MOST_NEAR)
            near[at] = uint(b * TEAM + id);
        found += bitCount(bits);
    }
    barrier();
    return found;
}

// Sums the polynomials of all far sensors into result: 10 coefficients of weights, of weights times values, and of weights of uncertain
// sensors.
void add_far(float limit, float top)
{
    Polynomial none = Polynomial(0.0, vec3(0.0), vec3(0.0), vec3(0.0)), total = none, values = none, marked = none;
    for (int i = id; i < count; i += TEAM) {
        if (!(errors[i] >= 0.0 && errors[i] <= limit))
            continue;
        Sensor of = sensors[i];
        float distance_m;
        vec3 away = away_from(of, distance_m);
        Jet jet = jet_of(of, distance_m, false, top), term = jet;
        if (paper)
            term = jet_of(of, distance_m, true, top);
        add_terms(total, jet, 1.0, distance_m, away);
        add_terms(values, term, of.value, distance_m, away);
        if ((of.state & UNCERTAIN) != 0u)
            add_terms(marked, jet, 1.0, distance_m, away);
    }
    put_polynomial(0, total);
    put_polynomial(10, values);
    put_polynomial(20, marked);
    collect(30, false);
}

void main()
{
    int list = int(gl_WorkGroupID.x), start = list * LIST_WORDS;
    int number = int(grid_lists[grid_cells.x * grid_cells.y * grid_cells.z + list]);
    ivec3 cell = ivec3(number, number / grid_cells.x, number / (grid_cells.x * grid_cells.y)) % grid_cells.xyz;
    id = int(gl_LocalInvocationID.x);
    count = sensors.length();
    paper = choice.x != 0;
    reaches = !isinf(numbers.z);
    inverse_square = !paper && numbers.x == 2.0 && !reaches;
    centre_m = grid_corner_m.xyz + grid_corner_m.w * (vec3(cell) + 0.5);
    radius_m = 0.8660254 * grid_corner_m.w * 1.0001 + 1e-6;
    vec4 nearest = bound_nearest();
    float allowed = budget.z * bound_errors(nearest);
    float limit = choose_limit(allowed < FAR_M ? allowed : 0.0);
    int found = find_near(limit);
    add_far(limit, nearest.w);
    if (id < COLUMNS) {
        int k = id % 10;
        words[start + id / 10 * 12 + (k < 7 ? k : k + 1)] = floatBitsToUint(result[id]);
    }
    if (id < MOST_NEAR / 2)
        words[start + 36 + id] = (2 * id < found ? near[2 * id] : 0u) | (2 * id + 1 < found ? near[2 * id + 1] : 0u) << 16;
    if (id == 0) {
        words[start + 7] = floatBitsToUint(nearest.w);
        words[start + 11] = floatBitsToUint(found <= MOST_NEAR ? float(found) : -1.0);
    }
}
#endif
