/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the matrix G, the weight of each sensor at each vertex, one block of vertices at a time. A column of G holds one
   sensor's weights, which follow from the sensor's distances. */
#include "field/weights.h"

#include <math.h>
#include <string.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "base/mem.h"
#include "base/system/huge_pages.h"
#include "plant/influence.h"

/* for the interpolation gp (Gaussian process): smallest fraction of the variance expected without readings that readings must
   remove for a vertex to have data */
#define MIN_KNOWN_PART 0.1
/* for the interpolation fin, which computes a value as a mean of the sensors' readings and the ambient value (of the
   surroundings): smallest share of the sensors in that mean with which a vertex has data */
#define MIN_SENSOR_SHARE 0.1

/* largest standard deviation that the interpolation gp (Gaussian process) shows, as a multiple of that expected without
   readings; without this limit it would be unbounded on a body whose sensors are all lost */
#define MAX_DEVIATIONS 4.0

/* first part of the key by which cached weights are found: everything common to all sensors. Must have no padding, because keys
   are compared bytewise */
struct key_head {
    const struct asset *file;
    uint32_t interpolation, distance;
    float power, reach_m, radius_m;
    /* id of the trial whose sensor positions the layout has; 0: the configured positions. The number of sensors is not in the
       key, because the key's length determines it */
    uint32_t trial;
};
struct key_sensor {
    uint32_t column, usable;
    float strength, decay;
};

/* Returns a sensor's strength (factor of its weight). For the interpolation paper it is multiplied by the user's factor for all
   sensors; in shepard's sum such a common factor would cancel out. */
static float strength_of(const struct layout_sensor *sensor, const struct field_params *params)
{
    const struct field_override *override = field_params_override_of(params, sensor->tag);
    float own = override && override->strength >= 0 ? override->strength : sensor->strength;
    return fminf(params->interpolation == INTERPOLATION_PAPER ? own * (float)params->strength : own, KERNEL_FACTOR_LIMIT);
}

static float decay_of(const struct layout_sensor *sensor, const struct field_params *params)
{
    const struct field_override *override = field_params_override_of(params, sensor->tag);
    float own = override && override->decay >= 0 ? override->decay : sensor->decay;
    return params->interpolation == INTERPOLATION_PAPER ? fminf(own * (float)params->decay, KERNEL_FACTOR_LIMIT) : 0.0f;
}

void weights_key_init(struct weights_key *key, const struct field_layout *layout, const struct field_params *params, float radius_m,
                      const uint8_t *usable)
{
    bool paper = params->interpolation == INTERPOLATION_PAPER;
    key->count = sizeof(struct key_head) + layout->sensor_count * sizeof(struct key_sensor);
    key->bytes = mem_array(1, key->count);
    struct key_head *head = key->bytes;
    *head = (struct key_head){
        .file = layout->file,
        .interpolation = params->interpolation,
        .distance = params->distance,
        .power = paper ? 0 : (float)params->power,
        .reach_m = (float)params->reach_m,
        .radius_m = paper ? radius_m : 0,
        .trial = layout->trial,
    };
    struct key_sensor *sensors = (struct key_sensor *)(head + 1);
    for (size_t i = 0; i < layout->sensor_count; i++)
        sensors[i] = (struct key_sensor){
            .column = layout->sensors[i].column,
            .usable = usable[i],
            .strength = strength_of(&layout->sensors[i], params),
            .decay = decay_of(&layout->sensors[i], params),
        };
    key->hash = XXH3_64bits(key->bytes, key->count);
}

void weights_key_finish(struct weights_key *key)
{
    mem_free(key->bytes);
    *key = (struct weights_key){ 0 };
}

bool weights_key_equal(const struct weights_key *a, const struct weights_key *b)
{
    return a->hash == b->hash && a->count == b->count && memcmp(a->bytes, b->bytes, a->count) == 0;
}

/* Returns the entry for this interpolation in the asset's influence file, in which plantcast-prep stores weights; NULL: the
   interpolation is computed from distances, or nothing is stored for these sensor positions. */
static const struct influence_entry *influence_of(const struct field_layout *layout, enum interpolation interpolation)
{
    const struct influence_entry *entry = interpolation_is_prepared(interpolation) && !layout->trial && !layout->assumed
                                              ? influence_find(&layout->file->influence, layout->number, interpolation)
                                              : NULL;
    return entry && entry->sensor_count == layout->sensor_count ? entry : NULL;
}

static size_t block_count(size_t vertex_count)
{
    return (vertex_count + KERNEL_BLOCK - 1) / KERNEL_BLOCK;
}

static void choose_members(struct weights *weights, const struct field_params *params, const uint8_t *usable)
{
    const struct field_layout *layout = weights->layout;
    for (size_t i = 0; i < layout->sensor_count; i++) {
        weights->strength[i] = strength_of(&layout->sensors[i], params);
        weights->decay[i] = decay_of(&layout->sensors[i], params);
        weights->configured[i] = (weights->interpolation != INTERPOLATION_SHEPARD || weights->strength[i] > 0) && usable[i] != SENSOR_ASIDE;
        if (usable[i] == SENSOR_NO_LIMITS && weights->configured[i])
            weights->configured[i] = SENSOR_NO_LIMITS;
        weights->takes_part[i] = usable[i] == SENSOR_USED && weights->configured[i];
        if (weights->takes_part[i] || weights->prepared)
            weights->members[weights->member_count++] = (uint32_t)i;
    }
    weights->alike = true;
    for (size_t m = 1; m < weights->member_count; m++)
        weights->alike &= weights->strength[weights->members[m]] == weights->strength[weights->members[0]];
}

/* Returns the number of steps of scalar.lacking per metre. That byte encodes a vertex's distance beyond the border between data
   and no data: 127 is the border, larger values are beyond it. The 127 steps on either side span a fifth of the asset's
   diagonal. drawn_error_measure() marks triangles that are too large for this. */
static float steps_per_m(const struct field_layout *layout)
{
    const struct asset_header *header = layout->file->view.header;
    float square = 0;
    for (int c = 0; c < 3; c++)
        square += (header->bounds_max_m[c] - header->bounds_min_m[c]) * (header->bounds_max_m[c] - header->bounds_min_m[c]);
    return square > 0 ? 127 / (0.2f * sqrtf(square)) : 127;
}

static bool take_errors(struct weights *weights, const float *errors)
{
    size_t erring[WEIGHTS_ERRING] = { 0 };
    weights->errors = mem_try_array(weights->layout->vertex_count, sizeof(*errors));
    for (size_t v = 0; weights->errors && v < weights->layout->vertex_count; v++) {
        weights->errors[v] = errors[v];
        weights->largest_error = fmaxf(weights->largest_error, errors[v]);
        for (int b = 0; b < WEIGHTS_ERRING; b++)
            erring[b] += errors[v] >= ldexpf(1, -b);
    }
    for (int b = 0; b < WEIGHTS_ERRING; b++) /* counts vertices in integers, because counting in a float would stop at 2^24 */
        weights->erring[b] = (float)((double)erring[b] / (double)weights->layout->vertex_count);
    weights->errors_version = 1;
    return weights->errors;
}

/* Uses the weights that plantcast-prep stored in the influence file unchanged, without division by their sum. Where a vertex's
   weights add up to less than 1, the ambient value (of the surroundings) has the remaining weight. */
static bool take_prepared(struct weights *weights, const struct influence_entry *entry)
{
    const struct field_layout *layout = weights->layout;
    const struct influence_view *influence = &layout->file->influence;
    for (size_t v = 0; v < layout->vertex_count; v++)
        weights->total[v] = 1;
    memset(weights->known, KNOWN_TOP | KNOWN_TOTAL, block_count(layout->vertex_count));
    weights->decay_m = (float)entry->decay_m;
    if (weights->interpolation == INTERPOLATION_GP) {
        weights->deviations = influence_array(influence, entry->deviations);
        weights->priors = weights->deviations + layout->vertex_count;
        weights->deviation = (float)entry->deviation;
        weights->decay_m = (float)(entry->range_m / sqrt(8));
    }
    if (weights->interpolation == INTERPOLATION_FIN || weights->interpolation == INTERPOLATION_GP)
        weights->beyond_m = mem_try_array(layout->vertex_count, sizeof(float));
    if (memchr(weights->takes_part, 0, layout->sensor_count))
        weights->fill = influence_fill_create(influence_array(influence, entry->precision), layout->sensor_count, weights->takes_part);
    weights->ones = mem_array(layout->sensor_count, sizeof(*weights->ones));
    for (size_t i = 0; i < layout->sensor_count; i++)
        weights->ones[i] = 1;
    if (weights->fill)
        influence_fill_values(weights->fill, weights->ones);
    weights->prepared_errors = entry->errors ? influence_array(influence, entry->errors) : NULL;
    if (weights->prepared_errors && !take_errors(weights, weights->prepared_errors))
        return false;
    return weights->beyond_m || weights->interpolation == INTERPOLATION_HARMONIC;
}

struct weights *weights_create(const struct field_layout *layout, const struct field_params *params, float radius_m, const uint8_t *usable,
                               struct weights_key *key)
{
    struct weights *weights = mem_new(sizeof(*weights));
    weights->layout = layout;
    weights->interpolation = params->interpolation;
    /* interpolations prepared by plantcast-prep always use distances along the surface, whatever the user chose */
    weights->distance = field_params_distance(params);
    weights->power = (float)params->power;
    weights->reach_m = (float)params->reach_m;
    weights->radius_m = radius_m;
    weights->strength = mem_array(layout->sensor_count, sizeof(float));
    weights->decay = mem_array(layout->sensor_count, sizeof(float));
    weights->configured = mem_array(layout->sensor_count, 1);
    weights->takes_part = mem_array(layout->sensor_count, 1);
    weights->members = mem_array(layout->sensor_count, sizeof(*weights->members));
    weights->near_m = mem_try_array(layout->vertex_count, sizeof(float));
    weights->top = mem_try_array(layout->vertex_count, sizeof(float));
    weights->total = mem_try_array(layout->vertex_count, sizeof(float));
    weights->place = mem_try_array(layout->vertex_count, 1);
    weights->lost = mem_try_array(layout->vertex_count, 1);
    weights->steps_per_m = steps_per_m(layout);
    weights->known = mem_try_array(block_count(layout->vertex_count), 1);
    if (!weights->near_m || !weights->top || !weights->total || !weights->place || !weights->lost || !weights->known)
        goto error;
    const struct influence_view *influence = &layout->file->influence;
    const struct influence_entry *entry = influence_of(layout, params->interpolation);
    if (interpolation_is_prepared(params->interpolation) && !entry)
        goto error;
    weights->prepared = entry ? influence_array(influence, entry->shares) : NULL;
    choose_members(weights, params, usable);
    if (entry && !take_prepared(weights, entry))
        goto error;
    weights->key = *key;
    *key = (struct weights_key){ 0 };
    return weights;
error:
    weights_destroy(&weights);
    return NULL;
}

struct weights *weights_create_border(const struct field_layout *layout, const struct field_params *params, const uint8_t *usable)
{
    struct field_params border = *params;
    border.distance = field_params_distance(params);
    if (interpolation_is_prepared(params->interpolation))
        border.interpolation = INTERPOLATION_PAPER; /* `shepard` would leave out sensors of strength 0, which prepared weights use */
    struct weights *weights = weights_create(layout, &border, 1, usable, &(struct weights_key){ 0 });
    if (weights)
        memset(weights->known, KNOWN_TOP, block_count(layout->vertex_count)); /* only weights need `top` */
    return weights;
}

static bool same_sensors(const struct weights *a, const struct weights *b)
{
    return a->layout == b->layout && a->distance == b->distance && a->reach_m == b->reach_m && a->member_count == b->member_count &&
           memcmp(a->members, b->members, a->member_count * sizeof(*a->members)) == 0 &&
           memcmp(a->takes_part, b->takes_part, a->layout->sensor_count) == 0 &&
           memcmp(a->configured, b->configured, a->layout->sensor_count) == 0 && !a->beyond_m && !b->beyond_m;
}

static bool same_strengths(const struct weights *a, const struct weights *b)
{
    return a->interpolation == b->interpolation && a->radius_m == b->radius_m &&
           memcmp(a->strength, b->strength, a->layout->sensor_count * sizeof(*a->strength)) == 0;
}

void weights_copy_known(struct weights *weights, const struct weights *from)
{
    if (!same_sensors(weights, from))
        return;
    unsigned shared = KNOWN_NEAR;
    /* Copies those results of the weights `from` that are also valid for `weights`. If all sensors have the same strengths in
       both, only power and decay can differ. The array `top`, which scales weights, depends on neither; nor do the sums of
       weights (`total`) of the interpolation paper. */
    if (same_strengths(weights, from))
        shared |= KNOWN_TOP | (weights->interpolation == INTERPOLATION_PAPER ? KNOWN_TOTAL : 0);
    for (size_t block = 0, at = 0; at < weights->layout->vertex_count; block++, at += KERNEL_BLOCK) {
        size_t left = weights->layout->vertex_count - at, count = left < KERNEL_BLOCK ? left : KERNEL_BLOCK;
        unsigned new = from->known[block] & shared & ~weights->known[block];
        if (new &KNOWN_NEAR) {
            memcpy(weights->near_m + at, from->near_m + at, count * sizeof(*from->near_m));
            memcpy(weights->place + at, from->place + at, count);
            memcpy(weights->lost + at, from->lost + at, count);
        }
        if (new &KNOWN_TOP)
            memcpy(weights->top + at, from->top + at, count * sizeof(*from->top));
        if (new &KNOWN_TOTAL)
            memcpy(weights->total + at, from->total + at, count * sizeof(*from->total));
        weights->known[block] |= (uint8_t) new;
    }
}

void weights_destroy(struct weights **weights_ptr)
{
    struct weights *weights = *weights_ptr;
    if (!weights)
        return;
    weights_key_finish(&weights->key);
    mem_free(weights->strength);
    mem_free(weights->decay);
    mem_free(weights->configured);
    mem_free(weights->members);
    mem_free(weights->near_m);
    mem_free(weights->top);
    mem_free(weights->total);
    mem_free(weights->place);
    mem_free(weights->lost);
    mem_free(weights->blind_marks);
    mem_free(weights->known);
    mem_free(weights->columns);
    mem_free(weights->kept);
    mem_free(weights->takes_part);
    mem_free(weights->ones);
    mem_free(weights->beyond_m);
    mem_free(weights->errors);
    mem_free(weights->interpolation_errors);
    influence_fill_destroy(&weights->fill);
    mem_free(weights);
    *weights_ptr = NULL;
}

size_t weights_bytes(const struct field_layout *layout)
{
    size_t each_vertex = 4 * sizeof(float) + 2;
    size_t each_sensor = 2 * sizeof(float) + 1 + sizeof(uint32_t) + sizeof(struct key_sensor);
    return sizeof(struct weights) + sizeof(struct key_head) + layout->vertex_count * each_vertex + block_count(layout->vertex_count) +
           layout->sensor_count * each_sensor;
}

/* Returns the size in bytes of the weights of all sensors at one block of KERNEL_BLOCK vertices. */
static size_t block_bytes(const struct weights *weights)
{
    return weights->member_count * (KERNEL_BLOCK * sizeof(float) + 1);
}

size_t weights_column_bytes(const struct weights *weights)
{
    return block_count(weights->layout->vertex_count) * block_bytes(weights);
}

size_t weights_kept_bytes(const struct weights *weights)
{
    return weights->kept_blocks * block_bytes(weights);
}

size_t weights_keep(struct weights *weights, size_t bytes)
{
    if (weights->prepared)
        return 0;
    size_t blocks = block_count(weights->layout->vertex_count), fit = weights->member_count ? bytes / block_bytes(weights) : 0;
    weights->kept_blocks = fit < blocks ? fit : blocks;
    if (weights->kept_blocks == 0)
        return 0;
    weights->columns = mem_try_array(weights->kept_blocks * weights->member_count, KERNEL_BLOCK * sizeof(float));
    weights->kept = mem_try_array(weights->kept_blocks * weights->member_count, 1);
    if (!weights->columns || !weights->kept)
        weights_drop_columns(weights);
    huge_pages_advise(weights->columns, weights->kept_blocks * weights->member_count * KERNEL_BLOCK * sizeof(float));
    return weights_kept_bytes(weights);
}

void weights_drop_columns(struct weights *weights)
{
    mem_free(weights->columns);
    mem_free(weights->kept);
    weights->columns = NULL;
    weights->kept = NULL;
    weights->kept_blocks = 0;
}

bool weights_has_columns(const struct weights *weights, size_t begin)
{
    size_t block = begin / KERNEL_BLOCK;
    if (weights->prepared)
        return true;
    return block < weights->kept_blocks && !memchr(weights->kept + block * weights->member_count, 0, weights->member_count);
}

const float *weights_column(const struct weights *weights, size_t begin, uint32_t member)
{
    if (weights->prepared)
        return weights->prepared + member * weights->layout->vertex_count + begin;
    return weights->columns + (begin / KERNEL_BLOCK * weights->member_count + member) * KERNEL_BLOCK;
}

bool weights_is_complete(const struct weights *weights, size_t begin)
{
    uint8_t all = KNOWN_NEAR | KNOWN_TOP | KNOWN_TOTAL;
    return (weights->known[begin / KERNEL_BLOCK] & all) == all && weights_has_columns(weights, begin);
}

static const float *distances(const struct weights *weights, size_t sensor, size_t begin, size_t count, float *scratch)
{
    return layout_distances(weights->layout, weights->distance, sensor, begin, count, scratch);
}

/* Encodes a distance in metres beyond the border of the data (negative: inside) as struct scalar's `lacking`. */
static uint8_t encode_lacking(const struct weights *weights, float beyond_m)
{
    float steps = beyond_m * weights->steps_per_m;
    if (beyond_m > 0)
        return (uint8_t)(steps < 127 ? 128 + (int)steps : 255);
    return (uint8_t)(steps > -127 ? 127 + (int)steps : 0);
}

uint8_t weights_lacking_at(const struct weights *weights, size_t vertex, bool filled)
{
    float near_m = weights->near_m[vertex];
    if (weights->place[vertex] == PLACE_NO_LIMITS)
        return 0;
    if (near_m == INFINITY)
        return 255;
    uint8_t reach = weights->reach_m < INFINITY ? encode_lacking(weights, near_m - weights->reach_m) : 0;
    uint8_t share = weights->beyond_m ? encode_lacking(weights, weights->beyond_m[vertex]) : 0;
    reach = share > reach ? share : reach;
    return filled || weights->lost[vertex] < reach ? reach : weights->lost[vertex];
}

float weights_error_at(const struct weights *weights, size_t vertex)
{
    if (weights->errors_unknown)
        return WEIGHTS_SHOWS_NO_DATA;
    return weights->errors ? weights->errors[vertex] : 0;
}

bool weights_interpolates_blind(const struct weights *weights)
{
    return weights->distance != DISTANCE_EUCLIDEAN && !weights->layout->assumed && weights->member_count > 0;
}

bool weights_blind_off(const struct weights *weights, size_t vertex)
{
    return weights_interpolates_blind(weights) && (!weights->blind_marks || weights->blind_marks[vertex]);
}

/* Returns whether a vertex has data. near_m, lost_m, no_limits_m: distances from the nearest usable sensor, from the nearest
   sensor without a usable reading, and from the nearest sensor without alarm limits; the nearest of the three decides. reach_m:
   distance beyond which no sensor counts. */
static enum place place_of(float near_m, float lost_m, float no_limits_m, float reach_m)
{
    if (no_limits_m < near_m && no_limits_m <= lost_m && no_limits_m <= reach_m)
        return PLACE_NO_LIMITS;
    if (!(near_m <= reach_m) || near_m == INFINITY)
        return PLACE_NOBODY;
    return lost_m < near_m ? PLACE_LOST : PLACE_GOOD;
}

/* for the interpolation fin, computes how many metres nearer the sensors would have to be to determine MIN_SENSOR_SHARE of the
   value. The fraction that they determine falls by a factor of e per decay length. */
static void find_beyond(struct weights *weights, size_t begin, size_t count)
{
    double share[KERNEL_BLOCK] = { 0 };
    for (uint32_t m = 0; m < weights->member_count; m++) {
        const float *column = weights_column(weights, begin, m);
        kernel_add(share, &column, &weights->ones[m], 1, count, NULL);
    }
    for (size_t j = 0; j < count; j++)
        weights->beyond_m[begin + j] = share[j] > 1e-30 ? weights->decay_m * (float)log(MIN_SENSOR_SHARE / share[j]) : INFINITY;
}

void weights_deviations(const struct weights *weights, size_t begin, size_t count, float *out)
{
    double more[KERNEL_BLOCK] = { 0 };
    if (weights->fill)
        influence_fill_variances(weights->fill, weights->prepared + begin, weights->layout->vertex_count, count, more);
    for (size_t j = 0; j < count; j++) {
        double own = (double)weights->deviations[begin + j], most = MAX_DEVIATIONS * (double)weights->deviation;
        out[j] = (float)fmin(sqrt(own * own + more[j]), most);
    }
}

/* for the interpolation gp, computes how many metres nearer the sensors would have to be to remove MIN_KNOWN_PART of the
   variance expected without readings. The fraction that they remove falls by a factor of e^2 per decay length. */
static void find_unknown(struct weights *weights, size_t begin, size_t count)
{
    float deviations[KERNEL_BLOCK];
    weights_deviations(weights, begin, count, deviations);
    for (size_t j = 0; j < count; j++) {
        double part = (double)deviations[j] / fmax((double)weights->priors[begin + j], 1e-30), known = 1 - part * part;
        weights->beyond_m[begin + j] = known > 1e-30 ? weights->decay_m / 2 * (float)log(MIN_KNOWN_PART / known) : INFINITY;
    }
}

static void nearest(struct weights *weights, size_t begin, size_t count)
{
    float scratch[KERNEL_BLOCK], lost_m[KERNEL_BLOCK], no_limits_m[KERNEL_BLOCK], *near_m = weights->near_m + begin;
    for (size_t j = 0; j < count; j++)
        lost_m[j] = no_limits_m[j] = near_m[j] = INFINITY;
    for (size_t i = 0; i < weights->layout->sensor_count; i++)
        if (weights->configured[i])
            kernel_nearest(distances(weights, i, begin, count, scratch), count,
                           weights->takes_part[i]                       ? near_m
                           : weights->configured[i] == SENSOR_NO_LIMITS ? no_limits_m
                                                                        : lost_m);
    if (weights->beyond_m && weights->deviations)
        find_unknown(weights, begin, count);
    else if (weights->beyond_m)
        find_beyond(weights, begin, count);
    for (size_t j = 0; j < count; j++)
        weights->place[begin + j] = (uint8_t)place_of(near_m[j], lost_m[j], no_limits_m[j], weights->reach_m);
    for (size_t j = 0; weights->beyond_m && j < count; j++)
        if (weights->beyond_m[begin + j] > 0)
            weights->place[begin + j] = PLACE_NOBODY;
    for (size_t j = 0; j < count; j++)
        weights->lost[begin + j] = lost_m[j] < INFINITY ? encode_lacking(weights, near_m[j] - lost_m[j]) : 0;
}

void weights_prepare(struct weights *weights, size_t begin, size_t count)
{
    float scratch[KERNEL_BLOCK], *top = weights->top + begin;
    const float *near_m = weights->near_m + begin;
    uint8_t *known = &weights->known[begin / KERNEL_BLOCK];
    bool had_top = *known & KNOWN_TOP;
    if (had_top && *known & KNOWN_NEAR)
        return;
    if (!(*known & KNOWN_NEAR))
        nearest(weights, begin, count);
    *known |= KNOWN_NEAR | KNOWN_TOP;
    if (had_top)
        return;
    memset(top, 0, count * sizeof(*top));
    for (size_t m = 0; m < weights->member_count; m++) {
        uint32_t sensor = weights->members[m];
        const float *distance_m = distances(weights, sensor, begin, count, scratch);
        if (weights->interpolation == INTERPOLATION_PAPER)
            kernel_top_paper(distance_m, near_m, count, weights->reach_m, weights->radius_m, weights->strength[sensor], top);
        else
            kernel_top_shepard(distance_m, near_m, count, weights->strength[sensor], top);
    }
}

/* Working memory for up to KERNEL_COLUMNS columns (a column is one sensor's weights at a block), computed in one step of a sum. */
struct workroom {
    float near_log2[KERNEL_BLOCK], distance_m[KERNEL_BLOCK], weights[KERNEL_COLUMNS][KERNEL_BLOCK], terms[KERNEL_COLUMNS][KERNEL_BLOCK];
};

/* Computes one sensor's column (weights) for a block of vertices. term: receives the factor of the reading; weight: for
   `paper`, receives the weight, without the factor d^decay. weight NULL: computes only the term. */
static void make_column(const struct weights *weights, uint32_t member, size_t begin, size_t count, struct workroom *room, float *weight,
                        float *term)
{
    uint32_t sensor = weights->members[member];
    const struct kernel_column column = {
        .distance_m = distances(weights, sensor, begin, count, room->distance_m),
        .near_m = weights->near_m + begin,
        .top = weights->top + begin,
        .count = count,
        .reach_m = weights->reach_m,
        .strength = weights->strength[sensor],
        .decay = weights->decay[sensor],
        .power = weights->power,
        .near_log2 = room->near_log2,
        .alike = weights->alike,
        .radius_m = weights->radius_m,
    };
    if (weights->interpolation == INTERPOLATION_PAPER)
        kernel_paper(&column, weight, term);
    else
        kernel_shepard(&column, term);
}

/* Returns the KERNEL_COLUMNS cached columns (sensors' weights) to prefetch while the terms before index `done` are being added:
   the next columns of this block of vertices or, after its last ones, the first columns of the next block. Their memory may not
   be filled yet. NULL: fewer than KERNEL_COLUMNS columns are left, or they are not cached. */
static const float *const *columns_after(const struct weights *weights, size_t begin, const struct weights_terms *terms, size_t done,
                                         const float **room)
{
    if (done + KERNEL_COLUMNS > terms->count) {
        begin += KERNEL_BLOCK;
        done = 0;
    }
    if (done + KERNEL_COLUMNS > terms->count || begin / KERNEL_BLOCK >= weights->kept_blocks)
        return NULL;
    for (size_t k = 0; k < KERNEL_COLUMNS; k++)
        room[k] = weights_column(weights, begin, terms->members[done + k]);
    return room;
}

void weights_add(struct weights *weights, size_t begin, size_t count, const struct weights_terms *terms, const struct weights_sums *sums)
{
    static const double ones[KERNEL_COLUMNS] = { 1, 1, 1, 1, 1, 1, 1, 1 };
    bool paper = weights->interpolation == INTERPOLATION_PAPER, keeps = begin / KERNEL_BLOCK < weights->kept_blocks;
    /* number of columns (weights of one sensor at one block of vertices) in all previous blocks */
    size_t before = begin / KERNEL_BLOCK * weights->member_count;
    struct workroom room;
    if (!paper && !weights->prepared && weights->power != 2.0f)
        kernel_log2(weights->near_m + begin, count, room.near_log2);
    for (size_t first = 0; first < terms->count; first += KERNEL_COLUMNS) {
        size_t left = terms->count - first, number = left < KERNEL_COLUMNS ? left : KERNEL_COLUMNS;
        const float *columns[KERNEL_COLUMNS], *heavy[KERNEL_COLUMNS], *after[KERNEL_COLUMNS];
        for (size_t k = 0; k < number; k++) {
            uint32_t member = terms->members[first + k];
            if (weights->prepared) {
                heavy[k] = columns[k] = weights_column(weights, begin, member);
                continue;
            }
            float *column = keeps ? weights->columns + (before + member) * KERNEL_BLOCK : room.terms[k];
            if (!keeps || !weights->kept[before + member] || (paper && sums->total))
                make_column(weights, member, begin, count, &room, sums->total ? room.weights[k] : NULL, column);
            if (keeps && !weights->kept[before + member])
                weights->kept[before + member] = 1;
            columns[k] = column;
            heavy[k] = paper ? room.weights[k] : column;
        }
        if (sums->total && !paper && number == KERNEL_COLUMNS) {
            kernel_add_both(sums->values, sums->total, columns, terms->factors + first, count);
        } else {
            kernel_add(sums->values, columns, terms->factors + first, number, count,
                       columns_after(weights, begin, terms, first + number, after));
            if (sums->total)
                kernel_add(sums->total, heavy, ones, number, count, NULL);
        }
        for (size_t k = 0; sums->marked && k < number; k++) {
            if (terms->marked[first + k] && !weights->deviations)
                kernel_add(sums->marked, &heavy[k], ones, 1, count, NULL);
            /* adds the absolute weights of Uncertain sensors: weights of the interpolation gp (Gaussian process) may be
               negative, and would otherwise cancel */
            for (size_t j = 0; terms->marked[first + k] && weights->deviations && j < count; j++)
                sums->marked[j] += fabs((double)heavy[k][j]);
        }
    }
}
