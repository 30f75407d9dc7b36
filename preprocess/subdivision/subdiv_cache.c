/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stores findings (measured errors of edges and triangles), keyed by a hash of the corners' positions. Decides whether a
 * finding of the last run is still valid. */
#include "preprocess/subdivision/subdiv_cache.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "preprocess/cache/build_cache.h"
#include "preprocess/subdivision/subdivide_impl.h"

#define MAX_CHANGES 16 /* maximum number of added and removed sensors with which the last run's findings (measured errors) are used */
#define FEW 16         /* the last run's findings (measured errors) are used only if fewer than one in FEW sensors has changed */
/* largest doubt of a finding (subdiv_cache.h: weight of the sensors changed since the measurement) with which it is used.
 * Measured: with this doubt, one in a thousand edges with an error of about one colour step is wrong by a tenth of a colour
 * step or more. */
#define MAX_DOUBT 0.05f
/* Largest doubt with which a finding (measured error) may be used at all. Above MAX_DOUBT, a finding is used only if the
 * changed sensors cannot move its error across a limit that decides whether the edge is split; otherwise the edge is measured
 * again. */
#define MAX_SETTLED 0.5f
/* interpolation error at an edge's midpoint, as a share of SUBDIV_AIM, below which the edge was not measured at other points */
#define LITTLE 0.4f

struct subdiv_cache_entry {
    uint64_t key;
    float error, share, barred, doubt, off;
    uint32_t jumps;
};

struct sensor { /* the parameters of a sensor that its interpolation weights depend on */
    float place_m[3], strength, power;
    uint32_t group;
};

struct subdiv_head {
    uint64_t sensors, findings, rest; /* numbers of sensors, of findings, and of 16-bit parts of optional numbers that follow in the file */
    /* levels dropped by earlier runs (bit mask), and number of sensors added or removed since these levels were last tried */
    uint64_t given_up, changes_since;
};

/* Flags for the optional numbers of a finding (measured error) that follow in the file, in the order of the flags. Most
 * findings have only a key and an error. */
#define SHARE_FOLLOWS 1
#define BARRED_FOLLOWS 2
/* two numbers of 16 bits follow: the doubt of the finding (weight of the sensors that changed since, subdiv_cache.h), and the amount by
 * which its error may be wrong */
#define DOUBT_FOLLOWS 4
#define SHARE_IS_HALF 8 /* flag: the best split fraction of the edge is 0.5; without this flag and SHARE_FOLLOWS it is 0 */
#define JUMPS 16

/* --- sensors ---------------------------------------------------------------------------------------------------------------------- */

static bool is_local(const struct linear_error_group *group)
{
    for (size_t i = 0; i < group->count; i++)
        if (!(group->of.strength[i] > 0) || group->of.strength[i] != group->of.strength[0])
            return false;
    return !group->papers && !(group->of.reach_m < INFINITY);
}

static int compare_sensors(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(struct sensor));
}

static void list_sensors(const struct linear_error *linear, struct text *list)
{
    for (uint32_t g = 0; g < linear->group_count; g++) {
        const struct linear_error_group *group = &linear->groups[g];
        for (size_t i = 0; i < group->count; i++) {
            struct sensor sensor = { .strength = group->of.strength[i], .power = group->of.power, .group = g };
            for (int axis = 0; axis < 3; axis++)
                sensor.place_m[axis] = linear->axes_m[axis][group->columns[i]];
            text_add_bytes(list, &sensor, sizeof(sensor));
        }
    }
    if (list->length > 0)
        qsort(list->at, list->length / sizeof(struct sensor), sizeof(struct sensor), compare_sensors);
}

static uint32_t column_of(const struct linear_error *linear, const struct sensor *sensor)
{
    const struct linear_error_group *group = &linear->groups[sensor->group];
    for (size_t i = 0; i < group->count; i++) {
        const float place_m[3] = { linear->axes_m[0][group->columns[i]], linear->axes_m[1][group->columns[i]],
                                   linear->axes_m[2][group->columns[i]] };
        if (memcmp(place_m, sensor->place_m, sizeof(place_m)) == 0)
            return group->columns[i];
    }
    return UINT32_MAX;
}

/* Finds the sensors added or removed since the last run by comparing the two runs' sorted lists of sensors. Returns false if
 * there are too many, or if one belongs to a group that no longer exists. */
static bool find_changes(struct subdiv_cache *cache, const struct linear_error *linear, const struct sensor *old, size_t old_count)
{
    const struct sensor *now = (const struct sensor *)(const void *)cache->sensors.at;
    size_t count = cache->sensors.length / sizeof(*now), i = 0, j = 0;
    cache->changes = mem_array(MAX_CHANGES, sizeof(*cache->changes));
    while (i < old_count || j < count) {
        int order = i == old_count ? 1 : j == count ? -1 : compare_sensors(&old[i], &now[j]);
        const struct sensor *changed = order < 0 ? &old[i] : &now[j];
        i += order <= 0;
        j += order >= 0;
        if (order == 0)
            continue;
        if (cache->change_count == MAX_CHANGES || FEW * cache->change_count >= count || changed->group >= linear->group_count)
            return false;
        struct subdiv_sensor_change *change = &cache->changes[cache->change_count++];
        *change = (struct subdiv_sensor_change){ .power = changed->power, .group = changed->group, .column = UINT32_MAX };
        memcpy(change->place_m, changed->place_m, sizeof(change->place_m));
        if (order > 0)
            change->column = column_of(linear, changed);
    }
    return true;
}

/* --- the file --------------------------------------------------------------------------------------------------------------------- */

/* bytes of a finding (measured error) in the file, without its optional numbers */
#define ENTRY_BYTES (sizeof(uint64_t) + sizeof(float) + 1)
#define REST_MAX 6 /* largest number of 16-bit parts of a finding's optional numbers */

/* Returns how many 16-bit parts of optional numbers a finding has: two for a float, one for a rounded number. */
static size_t rest_of(unsigned kind)
{
    return (kind & SHARE_FOLLOWS ? 2u : 0) + (kind & BARRED_FOLLOWS ? 2u : 0) + (kind & DOUBT_FOLLOWS ? 2u : 0);
}

/* Rounds a number >= 0 to the upper 16 bits of its float. Rounds up, by at most 1 %, because doubts may be overestimated but not
 * underestimated. */
static uint16_t round_up(float number)
{
    uint32_t bits;
    memcpy(&bits, &number, sizeof(bits));
    return (uint16_t)((bits + 0xffffu) >> 16);
}

static float rounded(uint16_t upper)
{
    const uint32_t bits = (uint32_t)upper << 16;
    float number;
    memcpy(&number, &bits, sizeof(number));
    return number;
}

static void index_findings(struct subdiv_cache *cache, size_t count)
{
    cache->finding_count = count;
    cache->mask = 15;
    while (cache->mask < 2 * count)
        cache->mask = cache->mask * 2 + 1;
    cache->slots = mem_array(cache->mask + 1, sizeof(*cache->slots));
    for (uint32_t i = 0; i < count; i++) {
        size_t slot = cache->keys[i] & cache->mask;
        while (cache->slots[slot])
            slot = (slot + 1) & cache->mask;
        cache->slots[slot] = i + 1;
    }
}

/* Computes for each finding (measured error) the index of its optional numbers in `rest`. Returns the length of `rest` that all findings
 * need. */
static size_t index_rest(struct subdiv_cache *cache, size_t count)
{
    size_t rest = 0;
    cache->rest_at = mem_array(count, sizeof(*cache->rest_at));
    for (size_t i = 0; i < count; i++) {
        cache->rest_at[i] = (uint32_t)rest;
        rest += rest_of(cache->kinds[i]);
    }
    return rest;
}

static void read_file(struct subdiv_cache *cache, const struct linear_error *linear)
{
    struct subdiv_head head = { 0 };
    if (cache->file.count < sizeof(head))
        return;
    memcpy(&head, cache->file.bytes, sizeof(head));
    size_t left = cache->file.count - sizeof(head);
    if (head.sensors > left / sizeof(struct sensor) || head.findings > left / ENTRY_BYTES || head.findings > UINT32_MAX / REST_MAX ||
        head.rest > left / sizeof(*cache->rest) ||
        left != head.sensors * sizeof(struct sensor) + head.findings * ENTRY_BYTES + head.rest * sizeof(*cache->rest))
        return;
    const char *sensors = cache->file.bytes + sizeof(head), *keys = sensors + head.sensors * sizeof(struct sensor);
    if (!find_changes(cache, linear, (const struct sensor *)(const void *)sensors, head.sensors))
        return;
    cache->keys = (const uint64_t *)(const void *)keys;
    cache->errors = (const float *)(const void *)(cache->keys + head.findings);
    cache->rest = (const uint16_t *)(const void *)(cache->errors + head.findings);
    cache->kinds = (const unsigned char *)(cache->rest + head.rest);
    if (index_rest(cache, head.findings) != head.rest)
        return;
    index_findings(cache, head.findings);
    if (FEW * (head.changes_since + cache->change_count) < cache->sensors.length / sizeof(struct sensor)) {
        cache->hopeless = head.given_up;
        cache->changes_since = head.changes_since + cache->change_count;
    }
}

void subdiv_cache_open(struct subdiv_cache *cache, struct log *log, const char *folder, uint64_t key, const struct linear_error *linear)
{
    *cache = (struct subdiv_cache){ .applies = true };
    for (size_t g = 0; g < linear->group_count; g++)
        cache->applies &= is_local(&linear->groups[g]);
    if (cache->applies)
        list_sensors(linear, &cache->sensors);
    if (cache->applies && build_cache_open(&cache->file, log, folder, BUILD_CACHE_SUBDIVISION, key))
        read_file(cache, linear);
}

void subdiv_cache_close(struct subdiv_cache *cache)
{
    cache_file_close(&cache->file);
    mem_free(cache->slots);
    mem_free(cache->rest_at);
    mem_free(cache->changes);
    text_finish(&cache->sensors);
    text_finish(&cache->found);
    *cache = (struct subdiv_cache){ 0 };
}

/* this run's findings (measured errors) as arrays, in the layout of the cache file */
struct packed_findings {
    uint64_t *keys;
    float *errors;
    uint16_t *rest;
    unsigned char *kinds;
    size_t count, rest_count;
};

/* Packs a finding (measured error): rest receives its optional numbers in 16-bit parts. Returns the flags that say which
   optional numbers there are. */
static unsigned char pack_finding(const struct subdiv_cache_entry *found, uint16_t rest[REST_MAX])
{
    unsigned kind = found->jumps ? JUMPS : 0;
    kind |= found->share == 0.5f ? SHARE_IS_HALF : found->share != 0 ? SHARE_FOLLOWS : 0;
    kind |= found->barred != 0 ? BARRED_FOLLOWS : 0;
    kind |= found->doubt != 0 || found->off != 0 ? DOUBT_FOLLOWS : 0;
    if (kind & SHARE_FOLLOWS) {
        memcpy(rest, &found->share, sizeof(found->share));
        rest += 2;
    }
    if (kind & BARRED_FOLLOWS) {
        memcpy(rest, &found->barred, sizeof(found->barred));
        rest += 2;
    }
    if (kind & DOUBT_FOLLOWS) {
        rest[0] = round_up(found->doubt);
        rest[1] = round_up(found->off);
    }
    return (unsigned char)kind;
}

static void pack_findings(const struct subdiv_cache *cache, struct packed_findings *packed)
{
    const struct subdiv_cache_entry *found = (const struct subdiv_cache_entry *)(const void *)cache->found.at;
    size_t count = cache->found.length / sizeof(*found);
    *packed = (struct packed_findings){ .keys = mem_array(count, sizeof(*packed->keys)),
                                        .errors = mem_array(count, sizeof(*packed->errors)),
                                        .rest = mem_array(REST_MAX * (count + 1), sizeof(*packed->rest)),
                                        .kinds = mem_array(count, 1),
                                        .count = count };
    for (size_t i = 0; i < count; i++) {
        packed->keys[i] = found[i].key;
        packed->errors[i] = found[i].error;
        packed->kinds[i] = pack_finding(&found[i], packed->rest + packed->rest_count);
        packed->rest_count += rest_of(packed->kinds[i]);
    }
}

void subdiv_cache_write(const struct subdiv_cache *cache, const char *folder, uint64_t key)
{
    struct packed_findings packed;
    if (!cache->applies)
        return;
    pack_findings(cache, &packed);
    const struct subdiv_head head = { cache->sensors.length / sizeof(struct sensor), packed.count, packed.rest_count, cache->given_up,
                                      cache->changes_since };
    const struct atomic_file_part parts[] = { { &head, sizeof(head) },
                                              { cache->sensors.at, cache->sensors.length },
                                              { packed.keys, packed.count * sizeof(*packed.keys) },
                                              { packed.errors, packed.count * sizeof(*packed.errors) },
                                              { packed.rest, packed.rest_count * sizeof(*packed.rest) },
                                              { packed.kinds, packed.count } };
    build_cache_write(folder, BUILD_CACHE_SUBDIVISION, key, parts, sizeof(parts) / sizeof(*parts));
    mem_free(packed.keys);
    mem_free(packed.errors);
    mem_free(packed.rest);
    mem_free(packed.kinds);
}

/* --- findings --------------------------------------------------------------------------------------------------------------------- */

/* Returns a cache key for the edge or triangle with these corners, independent of their order. */
uint64_t subdiv_cache_key(const struct subdiv *subdiv, const uint32_t *corners, size_t count)
{
    if (!subdiv->in->cache || !subdiv->in->cache->applies)
        return 0;
    float places_m[3][3];
    for (size_t c = 0; c < count; c++) {
        const float *place_m = subdiv_position(subdiv, corners[c]);
        size_t at = c;
        for (; at > 0 && memcmp(places_m[at - 1], place_m, sizeof(*places_m)) > 0; at--)
            memcpy(places_m[at], places_m[at - 1], sizeof(*places_m));
        memcpy(places_m[at], place_m, sizeof(*places_m));
    }
    return XXH3_64bits_withSeed(places_m, count * sizeof(*places_m), subdiv->level);
}

/* Distances in metres between an edge or triangle and a sensor that was added or removed. */
struct change_range {
    double wide_m; /* largest distance from the centre of the edge or triangle to one of its corners */
    double near_m; /* distance from a corner to the nearest sensor of the group, the largest of all corners */
    double far_m;  /* lower bound of the distance from the edge or triangle to the changed sensor */
};

/* Returns an upper bound of the interpolation error between these corners that an added sensor's weight causes: through the
 * weight's curvature, and through a kink where two paths along the surface are equally long. An edge can have a kink only if
 * the distance to the sensor grows along it by less than its length. share: upper bound of the weight. */
static float bend_of(const struct subdiv *subdiv, const struct subdiv_sensor_change *change, const uint32_t *corners, size_t count,
                     const struct change_range *range, double share)
{
    const double wide_m = range->wide_m, near_m = range->near_m, far_m = range->far_m;
    const double p = (double)change->power, near = wide_m / fmax(near_m, 1e-9), far = wide_m / far_m;
    double low_m = INFINITY, high_m = 0;
    for (size_t c = 0; c < count; c++) {
        double m = (double)subdiv->geodesic_m[subdiv->mesh.welded.of_vertex[corners[c]] * subdiv->sensors + change->column];
        low_m = fmin(low_m, m);
        high_m = fmax(high_m, m);
    }
    double kink_m = high_m < INFINITY ? wide_m - (count == 2 ? (high_m - low_m) / 2 : 0) : 0, round_m = fmax(low_m - wide_m, far_m);
    double kink = pow(fmin(1, (near_m + wide_m) / round_m), p) * p * fmax(kink_m, 0) / round_m;
    return (float)(share * (p * (p - 1) / 2 * near * near + p * p * near * far + p * (p + 1) / 2 * far * far) + kink);
}

/* Returns an upper bound of the total weight of all added and removed sensors at any point between these corners. Uses
 * straight-line distances, which are at most the distances along the surface. */
static float share_of_changes(const struct subdiv *subdiv, const uint32_t *corners, size_t count, float *off)
{
    const struct subdiv_cache *cache = subdiv->in->cache;
    float middle[3] = { 0 }, share = 0;
    double wide_m = 0;
    *off = 0;
    for (size_t c = 0; c < count; c++)
        for (int axis = 0; axis < 3; axis++)
            middle[axis] += subdiv_position(subdiv, corners[c])[axis] / (float)count;
    for (size_t c = 0; c < count; c++)
        wide_m = fmax(wide_m, subdiv_length(middle, subdiv_position(subdiv, corners[c])));
    for (size_t i = 0; i < cache->change_count; i++) {
        const struct subdiv_sensor_change *change = &cache->changes[i];
        double near_m = 0, far_m = fmax(1e-9, subdiv_length(middle, change->place_m) - wide_m - subdiv->on_surface_m);
        for (size_t c = 0; c < count; c++) {
            uint32_t place = subdiv->mesh.welded.of_vertex[corners[c]];
            near_m = fmax(near_m, (double)subdiv->norms[place * subdiv->norm_count + change->group].near_m);
        }
        double ratio = (near_m + wide_m) / far_m;
        float own = ratio < 1 ? powf((float)ratio, change->power) : 1;
        share += own;
        if (change->column != UINT32_MAX && own < MAX_SETTLED)
            *off += bend_of(subdiv, change, corners, count, &(struct change_range){ wide_m, near_m, far_m }, (double)own);
    }
    return share;
}

/* Returns whether a cached error is so far from the limits SUBDIV_AIM and LITTLE that the added and removed sensors cannot have
 * moved it across either. doubt: weight of these sensors (subdiv_cache.h). */
static bool is_settled(const struct subdiv_cache_entry *old, float doubt, float off)
{
    const float matters = (float)SUBDIV_AIM, error = fmaxf(old->error, old->barred);
    float most = error / (1 - doubt) + off, least = error * (1 - 2 * doubt) - off;
    return doubt <= MAX_SETTLED && (most <= LITTLE * matters || (error > LITTLE * matters && most <= matters) || least > matters);
}

static void unpack_finding(const struct subdiv_cache *cache, size_t i, struct subdiv_cache_entry *found)
{
    const uint16_t *rest = cache->rest + cache->rest_at[i];
    unsigned kind = cache->kinds[i];
    *found = (struct subdiv_cache_entry){
        .key = cache->keys[i], .error = cache->errors[i], .share = kind & SHARE_IS_HALF ? 0.5f : 0, .jumps = (kind & JUMPS) != 0
    };
    if (kind & SHARE_FOLLOWS) {
        memcpy(&found->share, rest, sizeof(found->share));
        rest += 2;
    }
    if (kind & BARRED_FOLLOWS) {
        memcpy(&found->barred, rest, sizeof(found->barred));
        rest += 2;
    }
    if (kind & DOUBT_FOLLOWS) {
        found->doubt = rounded(rest[0]);
        found->off = rounded(rest[1]);
    }
}

/* Looks up a finding (measured error) by key and unpacks it to *found. *next: guess of its index, which is tried first, because
 * most findings are looked up in the order of the last run; receives the index after the one found. Returns false if the key is
 * absent. */
static bool find(const struct subdiv_cache *cache, uint64_t key, uint32_t *next, struct subdiv_cache_entry *found)
{
    if (*next >= cache->finding_count || cache->keys[*next] != key) {
        size_t slot = key & cache->mask;
        while (cache->slots[slot] && cache->keys[cache->slots[slot] - 1] != key)
            slot = (slot + 1) & cache->mask;
        if (!cache->slots[slot])
            return false;
        *next = cache->slots[slot] - 1;
    }
    unpack_finding(cache, (*next)++, found);
    return true;
}

bool subdiv_cache_find(const struct subdiv *subdiv, uint64_t key, const uint32_t *corners, size_t count, uint32_t *next,
                       struct subdiv_finding *finding)
{
    const struct subdiv_cache *cache = subdiv->in->cache;
    struct subdiv_cache_entry old;
    if (!cache || !cache->slots || !find(cache, key, next, &old))
        return false;
    float off, doubt = old.doubt + share_of_changes(subdiv, corners, count, &off);
    off += old.off;
    if (!(doubt <= MAX_DOUBT) && !is_settled(&old, doubt, off))
        return false;
    *finding = (struct subdiv_finding){ .number = finding->number,
                                        .error = old.error,
                                        .share = old.share,
                                        .barred = old.barred,
                                        .jumps = old.jumps != 0,
                                        .is_cached = true,
                                        .doubt = doubt,
                                        .off = off };
    return true;
}

void subdiv_cache_add(struct subdiv *subdiv, const struct subdiv_finding *finding)
{
    struct subdiv_cache *cache = subdiv->in->cache;
    if (!cache)
        return;
    cache->measured_count += !finding->is_cached;
    cache->kept_count += finding->is_cached;
    if (!cache->applies)
        return;
    const struct subdiv_cache_entry found = { .key = finding->key,
                                              .error = finding->error,
                                              .share = finding->share,
                                              .barred = finding->barred,
                                              .doubt = finding->doubt,
                                              .off = finding->off,
                                              .jumps = finding->jumps };
    text_add_bytes(&cache->found, &found, sizeof(found));
}
