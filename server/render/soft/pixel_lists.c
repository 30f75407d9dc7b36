/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes lists of near sensors (pixel_lists.h): decides for each square of pixels which sensors are near and which are far. The surface
   points that a square shows lie in a box. A sensor is far if its weight is so smooth in the box that a quadratic Taylor polynomial or a
   constant can replace it. The sum of the error bounds of all far sensors stays below an allowed fraction of the smallest possible sum of
   all weights. Sensors that may be the nearest somewhere in the box are always near. */
#include "render/soft/pixel_lists.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"

/* DEPTH: number of sizes of squares, whose sides are from 128 to 16 pixels. SHORT_LIST: lists of at most this many sensors are
   not shortened further */
enum { DEPTH = 4, SHORT_LIST = 8 };
static const float FAR_M = 1e15f, MOST_SHARE = 0.0625f, LOG2_E = 1.44269504f;

enum node_column { PLACE_X, PLACE_Y, PLACE_Z, VALUE, STRENGTH, DECAY, STATE, INDEX, COLUMNS };

struct node {
    /* Table of the near sensors, those that no polynomial replaces yet. It has one array for each value of enum node_column,
       padded to LANES. The arrays STATE and INDEX (index of the sensor in field->sensors) hold integers. */
    float *columns[COLUMNS];
    int count;
    /* polynomials that replace the far sensors (those whose weights are smooth in the square of pixels). The member `sensors`
       of this list is not used */
    struct pixel_list far;
    /* lower bound of the far sensors' weights, summed, at any pixel of the square; far sensors are those that polynomials
       replace */
    float least;
    /* error that further polynomials may still cause, as a fraction of the sum of all weights; decreases with each sensor that
       a polynomial replaces */
    float left;
};

struct building {
    const struct pixel_field *field;
    /* Values for converting an error of weights to an error of the field, for the interpolation `shepard`. If a sensor's weight
       has an error e (as a fraction of the sum of all weights), a value changes by at most e * (1/2 + away * |reading -
       middle|) * spread of the readings. For `paper`, away is 0 */
    float middle, away;
    /* [index in the parent's list]: largest change of a field value, in units of the readings' spread, if a polynomial replaces
       this sensor (it becomes far). INFINITY: the sensor must stay near; -1: the sensor has no weight */
    float *errors;
    struct node nodes[DEPTH + 1]; /* by level; [0]: all sensors */
};

struct box {
    float centre[3], radius;
};

float pixel_lists_step(const float *scale)
{
    const float range = 1 / scale[1], most = 0.75f / 255;
    return scale[2] > 0.5f ? lanes_exp2((lanes){ 0 } + scale[0])[0] * 0.69314718f * range * most : range * most;
}

/* --- weights as functions of the distance ---------------------------------------------------------------------------------------- */

struct eight_sensors {
    lanes at[3], value, strength, decay;
    /* masks of the sensors (of eight) in each state. counts: mask of the elements that hold a sensor; those beyond the end of
       the list hold none */
    lanes_int used, lost, no_limits, uncertain, counts;
};

SOFT_INLINE void load(const struct node *node, int first, struct eight_sensors *out)
{
    lanes_int state = *(const lanes_int *)(const void *)(node->columns[STATE] + first), zero = { 0 };
    out->counts = LANES_IOTA_INT < node->count - first;
    for (int c = 0; c < 3; c++)
        out->at[c] = lanes_choose(out->counts, *(const lanes *)(node->columns[c] + first), (lanes){ 0 });
    out->value = *(const lanes *)(node->columns[VALUE] + first);
    out->strength = *(const lanes *)(node->columns[STRENGTH] + first);
    out->decay = *(const lanes *)(node->columns[DECAY] + first);
    out->used = ((state & PIXEL_USABLE) != zero) & out->counts;
    out->no_limits = ((state & PIXEL_NO_LIMITS) != zero) & ~out->used & out->counts;
    out->lost = out->counts & ~out->used & ~out->no_limits;
    out->uncertain = ((state & PIXEL_UNCERTAIN) != zero) & out->counts;
}

SOFT_INLINE lanes all(float x)
{
    return (lanes){ 0 } + x;
}

/* Returns the interpolation weights of eight sensors at the given distances, times 2^-top so that they fit in floats. term
   true, only for the interpolation `paper` (Algorithm 1 of Kim & Suh): multiplies them by nearness^decay. */
SOFT_INLINE lanes weight_at(const struct pixel_field *field, const struct eight_sensors *of, lanes distance, bool term, float top)
{
    lanes log, zero = { 0 };
    lanes_int none = { 0 };
    if (field->paper) {
        lanes near = lanes_most((field->radius_m - distance) * (1 / field->radius_m), zero);
        log = near * of->strength * LOG2_E;
        if (term) {
            log += of->decay * lanes_log2(near);
            none = (near <= 1e-30f) & (of->decay > 0.0f);
        }
    } else {
        log = -field->power * lanes_log2(distance);
    }
    if (field->reach_m < INFINITY) {
        log += 2.0f * lanes_log2(1.0f - distance * (1 / field->reach_m));
        none |= distance >= field->reach_m;
    }
    lanes weight = lanes_choose(none, zero, lanes_exp2(lanes_least(log - top, all(100))));
    return field->paper ? weight : weight * of->strength;
}

/* Quadratic approximation of a sensor's weight within a box around the surface points of a square of pixels. It has the value
   and derivatives with respect to distance at the box's centre, a bound of the error, and the smallest weight in the box. tilt:
   added to the slope to lower the error. */
struct jet {
    lanes value, first, second, tilt, error, least;
};

/* Fills *out for weights that are strength / distance^2. q: radius / distance. p: distance of a place from the box's centre /
   radius. t: cosine of the angle between the place and the sensor, seen from the centre. The weight at the place is the weight
   at the centre times the sum over n of U_n(t) (p q)^n. U_n are the Chebyshev polynomials of the second kind, at most n + 1.
   Two terms are replaced by quadratic ones: U_3(t) p^3 differs from 2 t p by at most 2, and U_4(t) p^4 from 4 (t p)^2 - 1 by at
   most 2. Higher terms are neglected. out->error bounds all these errors. */
SOFT_INLINE void inverse_square_jet(const struct eight_sensors *of, lanes distance, float radius, float top, struct jet *out)
{
    lanes over = 1.0f / lanes_most(distance, all(1e-12f)), last = 1.0f / (distance + radius), q = lanes_least(radius * over, all(0.999f));
    lanes strength = of->strength * lanes_exp2(all(-top)), value = strength * over * over, q2 = q * q, left = 1.0f / (1.0f - q);
    out->value = value - value * q2 * q2;
    out->first = -2.0f * value * over;
    out->second = value * over * over * (6.0f + 8.0f * q2);
    out->tilt = out->first * q2;
    out->error = value * q2 * q * (2.0f + 2.0f * q + q2 * (6.0f - 5.0f * q) * left * left);
    out->least = strength * last * last;
}

/* First, second and third derivative of the logarithm of a sensor's weight with respect to distance. Each is a sum of terms of equal
   sign. */
struct logarithm {
    lanes first, second, third;
};

SOFT_INLINE void add_pole(struct logarithm *to, lanes times, lanes left)
{
    lanes over = 1.0f / left;
    to->first += times * over;
    to->second += times * over * over;
    to->third += 2.0f * times * over * over * over;
}

/* Returns bounds of the derivatives of log(weight) of each of eight sensors, for all points of a box around surface points.
   near_m, far_m: smallest and largest distance of the box from the sensor. The weight is a product. Its factor that grows
   without bound at the sensor (1 / distance^power) is bounded at near_m. Its factors that vanish at the reach or the radius R
   are bounded at far_m. sign: 1 or -1, with which the second derivatives of these latter factors are added. */
SOFT_INLINE struct logarithm logarithm_of(const struct pixel_field *field, const struct eight_sensors *of, lanes near_m, lanes far_m,
                                          bool term, float sign)
{
    struct logarithm out = { { 0 }, { 0 }, { 0 } }, back = out;
    if (field->paper) {
        lanes_int inside = near_m < field->radius_m;
        lanes slope = of->strength * (1 / field->radius_m);
        if (term)
            add_pole(&back, of->decay, field->radius_m - far_m);
        out.first = lanes_choose(inside, slope + back.first, (lanes){ 0 });
        back.second = lanes_choose(inside, back.second, (lanes){ 0 });
        back.third = lanes_choose(inside, back.third, (lanes){ 0 });
    } else {
        add_pole(&out, all(field->power), near_m);
    }
    if (field->reach_m < INFINITY) {
        struct logarithm reach = { { 0 }, { 0 }, { 0 } };
        add_pole(&reach, all(2), field->reach_m - far_m);
        out.first += reach.first;
        back.second += reach.second;
        back.third += reach.third;
    }
    out.second += sign * back.second;
    out.third += back.third;
    return out;
}

/* Fills *out with quadratic approximations of the weights of eight sensors in a box around surface points. distance: from each sensor to
   the box's centre. Correct only for weights that fall with distance, as all do. */
SOFT_INLINE void jet_of(const struct pixel_field *field, const struct eight_sensors *of, lanes distance, float radius, bool term, float top,
                        struct jet *out)
{
    lanes zero = { 0 }, near_m = lanes_most(distance - radius, zero), far_m = distance + radius;
    if (pixel_is_inverse_square(field)) {
        inverse_square_jet(of, distance, radius, top, out);
        return;
    }
    lanes most = weight_at(field, of, near_m, term, top), least = weight_at(field, of, far_m, term, top);
    lanes_int smooth = near_m > 1e-12f;
    if (field->paper)
        smooth &= (far_m < field->radius_m) | (near_m >= field->radius_m);
    if (field->reach_m < INFINITY)
        smooth &= far_m < field->reach_m;
    struct logarithm bound = logarithm_of(field, of, near_m, far_m, term, 1), here = logarithm_of(field, of, distance, distance, term, -1);
    lanes over = 1.0f / near_m, p1 = bound.first, along = p1 * p1 * p1 + 3.0f * p1 * bound.second + bound.third;
    lanes across = 3.0f * over * (p1 * p1 + bound.second + p1 * over);
    lanes error = most * (radius * radius * radius / 6) * lanes_most(along, across), middle = 0.5f * (most + least);
    smooth &= error < most - middle;
    lanes value = weight_at(field, of, distance, term, top);
    out->tilt = zero;
    out->value = lanes_choose(smooth, value, middle);
    out->first = lanes_choose(smooth, -value * here.first, zero);
    out->second = lanes_choose(smooth, value * (here.first * here.first + here.second), zero);
    out->error = lanes_choose(smooth, error, most - middle);
    out->least = least;
}

/* --- polynomials ------------------------------------------------------------------------------------------------------------------- */

static void move(float of[PIXEL_TERMS], const float by[3], float times)
{
    const float x = by[0], y = by[1], z = by[2];
    const float was[PIXEL_TERMS] = { of[0], of[1], of[2], of[3], of[4], of[5], of[6], of[7], of[8], of[9] };
    of[0] += x * (was[1] + x * was[4] + y * was[5] + z * was[6]) + y * (was[2] + y * was[7] + z * was[8]) + z * (was[3] + z * was[9]);
    of[1] += 2 * x * was[4] + y * was[5] + z * was[6];
    of[2] += x * was[5] + 2 * y * was[7] + z * was[8];
    of[3] += x * was[6] + y * was[8] + 2 * z * was[9];
    for (int i = 0; i < PIXEL_TERMS; i++)
        of[i] *= times;
}

SOFT_INLINE float sum_of(lanes x)
{
    return ((x[0] + x[4]) + (x[1] + x[5])) + ((x[2] + x[6]) + (x[3] + x[7]));
}

SOFT_INLINE float least_of(lanes x)
{
    float least = x[0];
    for (int i = 1; i < LANES; i++)
        least = x[i] < least ? x[i] : least;
    return least;
}

/* Adds the quadratic approximations of the weights of the chosen sensors (of eight) to the polynomial `to`. away: unit vectors from the
   sensors to the box's centre. */
SOFT_INLINE void add_terms(lanes to[PIXEL_TERMS], const struct jet *jet, lanes_int chosen, lanes times, lanes distance, const lanes away[3])
{
    const lanes zero = { 0 }, first = lanes_choose(chosen, times * jet->first, zero);
    lanes bend = first / lanes_most(distance, all(1e-12f)), second = 0.5f * (lanes_choose(chosen, times * jet->second, zero) - bend);
    const lanes slope = first + lanes_choose(chosen, times * jet->tilt, zero);
    to[0] += lanes_choose(chosen, times * jet->value, zero);
    for (int c = 0; c < 3; c++)
        to[1 + c] += slope * away[c];
    bend *= 0.5f;
    to[4] += second * away[0] * away[0] + bend;
    to[5] += 2.0f * second * away[0] * away[1];
    to[6] += 2.0f * second * away[0] * away[2];
    to[7] += second * away[1] * away[1] + bend;
    to[8] += 2.0f * second * away[1] * away[2];
    to[9] += second * away[2] * away[2] + bend;
}

/* --- choosing ------------------------------------------------------------------------------------------------------------------- */

SOFT_INLINE lanes distances_of(const struct eight_sensors *of, const struct box *box, lanes away[3])
{
    lanes square = { 0 };
    for (int c = 0; c < 3; c++) {
        away[c] = box->centre[c] - of->at[c];
        square += away[c] * away[c];
    }
    lanes distance = lanes_root(square), over = 1.0f / lanes_most(distance, all(1e-12f));
    for (int c = 0; c < 3; c++)
        away[c] *= over;
    return distance;
}

/* upper bounds of the distance from any surface point of a square of pixels to the nearest sensor that is used, lost, or has no
   limits; FAR_M: there is none */
struct nearest_bounds {
    float used, lost, no_limits;
    /* base-2 logarithm of about the largest weight of any sensor at these points. Weights are divided by the largest weight, so
       that they fit into floats */
    float top;
};

SOFT_INLINE void bound_nearest(const struct pixel_field *field, const struct node *from, const struct box *box, struct nearest_bounds *out)
{
    lanes used = all(FAR_M), lost = used, no_limits = used, top = { 0 }, away[3];
    for (int i = 0; i < from->count; i += LANES) {
        struct eight_sensors of;
        load(from, i, &of);
        lanes distance = distances_of(&of, box, away), far_m = distance + box->radius, far = all(FAR_M);
        used = lanes_least(used, lanes_choose(of.used, far_m, far));
        lost = lanes_least(lost, lanes_choose(of.lost, far_m, far));
        no_limits = lanes_least(no_limits, lanes_choose(of.no_limits, far_m, far));
        if (field->paper) {
            lanes exponent = of.strength * LOG2_E * (1.0f - distance * (1 / field->radius_m));
            top = lanes_most(top, lanes_choose(of.used, exponent, (lanes){ 0 }));
        }
    }
    *out = (struct nearest_bounds){ least_of(used), least_of(lost), least_of(no_limits), -least_of(-top) };
    if (!field->paper)
        out->top = -field->power * lanes_log2(all(out->used))[0];
    if (from->far.has_far)
        out->top = fmaxf(out->top, from->far.top);
}

struct centre_sums {
    lanes weights, by_distance, along[3];
};

/* Adds eight sensors to the sums from which least_by_centre() computes a lower bound of the sum of all weights. For weights of
   the form strength / distance^2. */
SOFT_INLINE void add_at_centre(const struct eight_sensors *of, lanes distance, float radius, float top, const lanes away[3],
                               struct centre_sums *sums)
{
    lanes over = 1.0f / lanes_most(distance, all(0.01f * radius)), q = radius * over, strength = of->strength * lanes_exp2(all(-top));
    lanes weight = lanes_choose(of->used, strength * over * over, (lanes){ 0 });
    sums->weights += weight;
    sums->by_distance += weight * q * q;
    for (int c = 0; c < 3; c++)
        sums->along[c] += weight * q * (distance * over) * away[c];
}

/* Returns a lower bound of the sum of all weights in a box around surface points. By Cauchy's inequality, the sum of s_i / D_i is at least
   (sum of p_i)^2 / (sum of p_i^2 D_i / s_i) for any p_i. D_i are squared distances, s_i strengths and p_i the weights at the box's centre,
   so the last sum is a quadratic function of the place. */
SOFT_INLINE float least_by_centre(const struct centre_sums *sums)
{
    float weights = sum_of(sums->weights), along = 0;
    for (int c = 0; c < 3; c++)
        along += sum_of(sums->along[c]) * sum_of(sums->along[c]);
    return weights > 0 ? weights * weights / (weights + 2 * sqrtf(along) + sum_of(sums->by_distance)) : 0;
}

/* Fills building->errors: for each sensor, a bound of the change of a field value if a polynomial replaces the sensor. Returns a lower
   bound, in the box, of the sum of the weights of the list's sensors. */
SOFT_INLINE float bound_errors(const struct building *building, const struct node *from, const struct box *box,
                               const struct nearest_bounds *nearest)
{
    const struct pixel_field *field = building->field;
    const float lost_m = fminf(nearest->used, nearest->lost), no_limits_m = fminf(nearest->used, nearest->no_limits);
    const bool square = pixel_is_inverse_square(field);
    struct centre_sums sums = { 0 };
    lanes least = { 0 }, away[3];
    for (int i = 0; i < from->count; i += LANES) {
        struct eight_sensors of;
        struct jet jet, term = { { 0 }, { 0 }, { 0 }, { 0 }, { 0 }, { 0 } };
        load(from, i, &of);
        lanes distance = distances_of(&of, box, away), near_m = distance - box->radius;
        jet_of(field, &of, distance, box->radius, false, nearest->top, &jet);
        if (field->paper)
            jet_of(field, &of, distance, box->radius, true, nearest->top, &term);
        lanes_int near = (of.used & (near_m <= nearest->used)) | (of.lost & (near_m <= lost_m)) | (of.no_limits & (near_m <= no_limits_m));
        lanes error = jet.error + term.error;
        if (!field->paper)
            error *= 0.5f + building->away * lanes_most(of.value - building->middle, building->middle - of.value);
        near |= of.used & ~(error < FAR_M);
        error = lanes_choose(near, all(INFINITY), lanes_choose(of.used, error, all(-1)));
        least += lanes_choose(of.used, jet.least, (lanes){ 0 });
        memcpy(building->errors + i, &error, sizeof(error));
        if (square)
            add_at_centre(&of, distance, box->radius, nearest->top, away, &sums);
    }
    return fmaxf(sum_of(least), square ? least_by_centre(&sums) : 0);
}

/* Returns the largest possible change of field values if polynomials replace all sensors whose error is at most `most`: the sum
   of these errors. */
SOFT_INLINE float sum_up_to(const float *errors, int count, float most)
{
    lanes sum = { 0 };
    for (int i = 0; i < count; i += LANES) {
        lanes error;
        memcpy(&error, errors + i, sizeof(error));
        sum += lanes_choose((error >= 0.0f) & (error <= most), error, (lanes){ 0 });
    }
    return sum_of(sum);
}

struct polynomials {
    lanes total[PIXEL_TERMS], values[PIXEL_TERMS], marked[PIXEL_TERMS], least;
};

SOFT_INLINE void add_far(const struct pixel_field *field, const struct eight_sensors *of, lanes_int far, const struct box *box, float top,
                         struct polynomials *to, bool *has_marks)
{
    struct jet jet, term;
    lanes away[3], distance = distances_of(of, box, away);
    jet_of(field, of, distance, box->radius, false, top, &jet);
    if (field->paper)
        jet_of(field, of, distance, box->radius, true, top, &term);
    add_terms(to->total, &jet, far, all(1), distance, away);
    add_terms(to->values, field->paper ? &term : &jet, far, of->value, distance, away);
    to->least += lanes_choose(far, jet.least, (lanes){ 0 });
    if (!lanes_any(far & of->uncertain))
        return;
    *has_marks = true;
    add_terms(to->marked, &jet, far & of->uncertain, all(1), distance, away);
}

SOFT_INLINE void keep(const struct node *from, int sensor, struct node *to)
{
    for (int c = 0; c < COLUMNS; c++)
        to->columns[c][to->count] = from->columns[c][sensor];
    to->count++;
}

/* Splits the list of sensors of the larger square. Sensors with an error of at most `most` become far and are added to the
   polynomials; the others stay in the list. */
SOFT_INLINE void split(const struct building *building, const struct node *from, const struct box *box, float most, float top,
                       struct node *to)
{
    struct polynomials sums = { 0 };
    const float *was = from->far.centre, by[3] = { box->centre[0] - was[0], box->centre[1] - was[1], box->centre[2] - was[2] };
    const float times = from->far.has_far ? lanes_exp2(all(from->far.top - top))[0] : 0;
    to->count = 0;
    to->far = from->far;
    to->far.top = top;
    memcpy(to->far.centre, box->centre, sizeof(box->centre));
    move(to->far.total, by, times);
    move(to->far.values, by, times);
    move(to->far.marked, by, times);
    for (int i = 0; i < from->count; i += LANES) {
        struct eight_sensors of;
        lanes error;
        memcpy(&error, building->errors + i, sizeof(error));
        load(from, i, &of);
        lanes_int far = (error >= 0.0f) & (error <= most) & of.counts;
        if (lanes_any(far))
            add_far(building->field, &of, far, box, top, &sums, &to->far.has_marks);
        to->far.has_far |= lanes_any(far) != 0;
        for (uint32_t near = lanes_bits((error > most) & of.counts); near; near &= near - 1)
            keep(from, i + __builtin_ctz(near), to);
    }
    for (int i = 0; i < PIXEL_TERMS && to->far.has_far; i++) {
        to->far.total[i] += sum_of(sums.total[i]);
        to->far.values[i] += sum_of(sums.values[i]);
        to->far.marked[i] += sum_of(sums.marked[i]);
    }
    to->least = from->least * times + sum_of(sums.least);
}

/* Makes the list of near sensors in a square of pixels from the list of the larger square around it. last true: the list may
   use all of the remaining error budget; false: it leaves a part for the smaller squares inside. */
static void make_node(const struct building *building, const struct node *from, const struct box *box, bool last,
                                  struct node *to)
{
    struct nearest_bounds nearest;
    bound_nearest(building->field, from, box, &nearest);
    float least = bound_errors(building, from, box, &nearest);
    if (from->far.has_far)
        least += from->least * lanes_exp2(all(from->far.top - nearest.top))[0];
    float allowed = (last ? 1 : 0.4f) * from->left * least, sum;
    allowed = allowed < FAR_M ? allowed : 0;
    float most = allowed;
    while ((sum = sum_up_to(building->errors, from->count, most)) > allowed)
        most *= 0.5f;
    split(building, from, box, most, nearest.top, to);
    to->left = from->left - (sum > 0 ? sum / least : 0);
}

/* --- squares of cells ------------------------------------------------------------------------------------------------------------ */

/* Computes the box that encloses the surface points of cells[first] and of all following cells in the same square of pixels. level: 0 for
   the largest squares; each next level halves their sides. */
static void bound_cells(const struct pixel_cell *cells, size_t count, size_t first, int level, struct box *out)
{
    const int shift = 2 * (DEPTH - level);
    float low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY }, square = 0;
    uint32_t order = pixel_cells_order(cells[first].column, cells[first].row) >> shift;
    for (size_t i = first; i < count && pixel_cells_order(cells[i].column, cells[i].row) >> shift == order; i++)
        for (int c = 0; c < 3; c++) {
            low[c] = fminf(low[c], cells[i].low[c]);
            high[c] = fmaxf(high[c], cells[i].high[c]);
        }
    for (int c = 0; c < 3; c++) {
        float half = 0.5f * (high[c] - low[c]);
        out->centre[c] = low[c] + half;
        square += half * half;
    }
    out->radius = sqrtf(square) * 1.0001f + 1e-6f;
}

/* Returns the first level at which two cells are in different squares (each level halves the sides of the squares). The cells
   must be neighbours in the order of pixel_cells_order(). */
static int level_apart(const struct pixel_cell *a, const struct pixel_cell *b)
{
    uint32_t differ = pixel_cells_order(a->column, a->row) ^ pixel_cells_order(b->column, b->row);
    int level = 2;
    while (level < DEPTH && differ >> (2 * (DEPTH - level)) == 0)
        level++;
    return level;
}

/* Returns the difference between the highest and the lowest reading (for `paper`, the largest absolute reading), times the field's scale.
   Sets building->middle to the value halfway between them, and building->away to the reciprocal of their difference. */
static float find_spread(struct building *building)
{
    const struct pixel_field *field = building->field;
    float low = INFINITY, high = -INFINITY;
    for (int i = 0; i < field->count; i++)
        if (field->sensors[i].state & PIXEL_USABLE) {
            low = fminf(low, field->sensors[i].value);
            high = fmaxf(high, field->sensors[i].value);
        }
    if (high > low) {
        building->middle = 0.5f * (low + high);
        building->away = 1 / (high - low);
    }
    return (field->paper ? fmaxf(fabsf(low), fabsf(high)) : high - low) * fabsf(field->scale);
}

static void add_list(struct pixel_lists *lists, const struct node *node, const struct pixel_cell *cell, bool repeats)
{
    mem_grow(&lists->lists, &lists->capacity, lists->count + 1, sizeof(*lists->lists));
    struct pixel_list *list = &lists->lists[lists->count++];
    *list = node->far;
    list->count = node->count;
    list->mesh = cell->mesh;
    list->column = cell->column;
    list->row = cell->row;
    list->first = lists->sensor_count;
    list->unit = lanes_exp2(all(list->top))[0];
    /* the cell (square of 16 x 16 pixels) has the same sensors as the cell before: both lists share one range of sensor indices */
    if (repeats) {
        list->first = list[-1].first;
        list->all_used = list[-1].all_used;
        return;
    }
    list->all_used = true;
    for (int i = 0; i < node->count; i++) {
        uint32_t state;
        memcpy(&state, node->columns[STATE] + i, sizeof(state));
        list->all_used &= (state & PIXEL_USABLE) != 0;
    }
    mem_grow(&lists->sensors, &lists->sensor_capacity, lists->sensor_count + (size_t)node->count + 1, sizeof(*lists->sensors));
    memcpy(lists->sensors + lists->sensor_count, node->columns[INDEX], (size_t)node->count * sizeof(*lists->sensors));
    lists->sensor_count += (size_t)node->count;
}

static void fill_root(struct building *building, float step)
{
    const struct pixel_field *field = building->field;
    const float spread = find_spread(building);
    struct node *root = &building->nodes[0];
    root->count = field->count;
    root->left = spread > 0 ? fminf(step * (1 - 2 * MOST_SHARE) / spread, MOST_SHARE) : MOST_SHARE;
    for (uint32_t i = 0; i < (uint32_t)field->count; i++) {
        const struct pixel_sensor *sensor = &field->sensors[i];
        const float *at = sensor->place_m, numbers[] = { at[0], at[1], at[2], sensor->value, sensor->strength, sensor->decay };
        for (int c = PLACE_X; c <= DECAY; c++)
            root->columns[c][i] = numbers[c];
        memcpy(root->columns[STATE] + i, &sensor->state, sizeof(sensor->state));
        memcpy(root->columns[INDEX] + i, &i, sizeof(i));
    }
}

void pixel_lists_add(struct pixel_lists *lists, const struct pixel_field *field, float step, const struct pixel_cell *cells, size_t count)
{
    const size_t padded = (size_t)field->count + LANES;
    struct building building = { .field = field };
    mem_grow(&lists->room, &lists->room_capacity, ((DEPTH + 1) * COLUMNS + 1) * padded, sizeof(*lists->room));
    float *next = lists->room + padded;
    int depth = DEPTH;
    building.errors = lists->room;
    for (int level = 0; level <= DEPTH; level++)
        for (int c = 0; c < COLUMNS; c++, next += padded)
            building.nodes[level].columns[c] = next;
    fill_root(&building, step);
    for (size_t i = 0; i < count; i++) {
        int level = i == 0 ? 1 : level_apart(&cells[i - 1], &cells[i]);
        bool repeats = level > depth;
        for (; level <= DEPTH && !repeats && building.nodes[level - 1].count > SHORT_LIST; level++) {
            struct box box;
            bound_cells(cells, count, i, level, &box);
            make_node(&building, &building.nodes[level - 1], &box, level == DEPTH, &building.nodes[level]);
        }
        depth = repeats ? depth : level - 1;
        add_list(lists, &building.nodes[depth], &cells[i], repeats);
    }
}

void pixel_lists_settle(struct pixel_lists *lists)
{
    for (size_t i = 0; i < lists->count; i++)
        lists->lists[i].sensors = lists->sensors + lists->lists[i].first;
}

void pixel_lists_finish(struct pixel_lists *lists)
{
    mem_free(lists->lists);
    mem_free(lists->sensors);
    mem_free(lists->room);
    *lists = (struct pixel_lists){ 0 };
}
