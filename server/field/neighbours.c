/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Predicts each sensor's reading from the other sensors (neighbours.h), with a prepared precision matrix or from distances. */
#include "field/neighbours.h"

#include <math.h>

#include "base/mem.h"
#include "field/influence_fill.h"
#include "field/layout.h"
#include "plant/influence.h"
#include "value/quality.h"

#define AT_ONE_PLACE 1e-6 /* metres; sensors closer together than this count as being at one point */

struct neighbours {
    struct field_layout *layout;
    /* data that plantcast-prep computed for the group's sensors (influence file); NULL: predictions come from distances */
    const struct influence_entry *entry;
    /* [to][from]: geodesic distances between sensors; INFINITY: no path, or unknown. NULL: not computed (too many sensors) */
    float *along_m;
};

static const struct influence_entry *entry_of(const struct field_layout *layout)
{
    static const enum interpolation order[] = { INTERPOLATION_GP, INTERPOLATION_HARMONIC, INTERPOLATION_FIN };
    for (size_t i = 0; i < sizeof(order) / sizeof(*order); i++) {
        const struct influence_entry *entry =
            plant_prepares(layout->group, order[i]) ? influence_find(&layout->file->influence, layout->number, order[i]) : NULL;
        if (entry && entry->sensor_count == layout->sensor_count)
            return entry;
    }
    return NULL;
}

/* Returns the geodesic distances between all pairs of sensors, [to][from]. The caller frees the array (mem_free). */
static float *distances_between(const struct field_layout *layout)
{
    const size_t n = layout->sensor_count;
    float *along_m = mem_array(n * n, sizeof(*along_m));
    for (size_t from = 0; from < n; from++) {
        const struct layout_sensor *sensor = &layout->sensors[from];
        bool known = layout_along(sensor, DISTANCE_GEODESIC) || layout_is_in_file(sensor, DISTANCE_GEODESIC);
        for (size_t to = 0; to < n; to++) {
            float room;
            along_m[to * n + from] =
                known ? *layout_distances(layout, DISTANCE_GEODESIC, from, layout->sensors[to].vertex, 1, &room) : (float)INFINITY;
        }
    }
    return along_m;
}

/* Returns true if another sensor with a usable reading is on the same connected surface (body). Otherwise, the prediction would
   consist of rounding errors. */
static bool is_predictable(const struct neighbours *neighbours, const uint8_t *used, size_t sensor)
{
    const size_t n = neighbours->layout->sensor_count;
    for (size_t j = 0; j < n; j++)
        if (j != sensor && used[j] && isfinite(neighbours->along_m[sensor * n + j]))
            return true;
    return false;
}

static double level_of(const struct field_layout *layout, const struct influence_entry *entry)
{
    return entry && entry->interpolation == INTERPOLATION_FIN ? layout->group->ambient : 0;
}

static void predict_prepared(const struct neighbours *neighbours, const uint8_t *used, struct neighbour *out)
{
    const struct field_layout *layout = neighbours->layout;
    const struct influence_entry *entry = neighbours->entry;
    const size_t n = layout->sensor_count;
    const double *precision = influence_array(&layout->file->influence, entry->precision);
    const double around = level_of(layout, entry);
    double *values = mem_array(n, sizeof(*values)), *own = mem_array(n, sizeof(*own));
    struct influence_fill *fill = influence_fill_create(precision, n, used);
    for (size_t i = 0; i < n; i++)
        values[i] = used[i] ? out[i].value - around : 0;
    influence_fill_values(fill, values);
    influence_fill_own(fill, own);
    for (size_t i = 0; i < n; i++) {
        double pull = 0;
        for (size_t j = 0; j < n; j++)
            pull += precision[i * n + j] * values[j];
        out[i].by = (enum interpolation)entry->interpolation;
        if (!(own[i] > 0) || !is_predictable(neighbours, used, i))
            continue;
        out[i].predicted = around + (used[i] ? values[i] - pull / own[i] : values[i]);
        if (entry->interpolation == INTERPOLATION_GP)
            out[i].deviation = 1 / sqrt(own[i]);
    }
    influence_fill_destroy(&fill);
    mem_free(values);
    mem_free(own);
}

static void predict_by_distance(const struct neighbours *neighbours, const uint8_t *used, struct neighbour *out)
{
    const struct field_layout *layout = neighbours->layout;
    for (size_t i = 0; i < layout->sensor_count; i++) {
        const float *along_m = neighbours->along_m + i * layout->sensor_count;
        double sum = 0, whole = 0, least_m = INFINITY;
        for (size_t j = 0; j < layout->sensor_count; j++) {
            const struct layout_sensor *other = &layout->sensors[j];
            double away_m = (double)along_m[j];
            if (j == i || !used[j] || !(away_m <= layout->group->reach_m) || !isfinite(away_m) || other->strength <= 0)
                continue;
            away_m = fmax(away_m, AT_ONE_PLACE);
            /* powers cannot overflow, because each sensor's weight is relative to that of the nearest sensor so far */
            double near = least_m / away_m;
            if (away_m < least_m) {
                double scale = isfinite(least_m) ? pow(away_m / least_m, layout->group->power) : 0;
                sum *= scale;
                whole *= scale;
                least_m = away_m;
                near = 1;
            }
            double fades = isfinite(layout->group->reach_m) ? 1 - away_m / layout->group->reach_m : 1;
            double weight = (double)other->strength * pow(near, layout->group->power) * fades * fades;
            sum += weight * out[j].value;
            whole += weight;
        }
        out[i].by = INTERPOLATION_SHEPARD;
        out[i].predicted = whole > 0 ? sum / whole : (double)NAN;
    }
}

struct neighbours *neighbours_create(const struct scene *scene, int asset, int group)
{
    struct field_layout *layout = layout_create(scene, asset, group, NULL);
    if (!layout || layout->assumed) {
        layout_destroy(&layout);
        return NULL;
    }
    struct neighbours *neighbours = mem_new(sizeof(*neighbours));
    *neighbours = (struct neighbours){ layout, entry_of(layout), NULL };
    if (layout->sensor_count <= NEIGHBOURS_MOST)
        neighbours->along_m = distances_between(layout);
    return neighbours;
}

void neighbours_destroy(struct neighbours **neighbours)
{
    if (*neighbours) {
        layout_destroy(&(*neighbours)->layout);
        mem_free((*neighbours)->along_m);
    }
    mem_free(*neighbours);
    *neighbours = NULL;
}

size_t neighbours_count(const struct neighbours *neighbours)
{
    return neighbours->layout->sensor_count;
}

int neighbours_tag(const struct neighbours *neighbours, size_t sensor)
{
    return neighbours->layout->sensors[sensor].tag;
}

double neighbours_level(const struct neighbours *neighbours)
{
    return level_of(neighbours->layout, neighbours->entry);
}

void neighbours_predict(const struct neighbours *neighbours, const double *values, struct neighbour *out)
{
    const struct field_layout *layout = neighbours->layout;
    const size_t count = layout->sensor_count;
    uint8_t *used = mem_array(count, 1);
    for (size_t i = 0; i < count; i++) {
        used[i] = isfinite(values[i]);
        out[i] = (struct neighbour){ layout->sensors[i].tag, INTERPOLATION_SHEPARD, used[i] ? values[i] : (double)NAN, NAN, NAN };
    }
    if (neighbours->along_m && neighbours->entry)
        predict_prepared(neighbours, used, out);
    else if (neighbours->along_m)
        predict_by_distance(neighbours, used, out);
    mem_free(used);
}

size_t neighbours_nearest(const struct neighbours *neighbours, size_t sensor, const bool *apart, size_t most, size_t *out)
{
    const struct field_layout *layout = neighbours->layout;
    double *away_m = mem_array(most, sizeof(*away_m));
    size_t count = 0;
    for (size_t j = 0; j < layout->sensor_count && neighbours->along_m; j++) {
        double m = j == sensor || apart[j] ? INFINITY : (double)neighbours->along_m[sensor * layout->sensor_count + j];
        size_t at = count;
        while (at > 0 && m < away_m[at - 1])
            at--;
        if (!isfinite(m) || at == most)
            continue;
        count += count < most;
        for (size_t k = count - 1; k > at; k--) {
            away_m[k] = away_m[k - 1];
            out[k] = out[k - 1];
        }
        away_m[at] = m;
        out[at] = j;
    }
    mem_free(away_m);
    return count;
}

/* Predicts the reading of each sensor from the readings of the others in a snapshot. The caller frees the result (mem_free). */
static struct neighbour *predict_from(const struct neighbours *neighbours, const struct snapshot *snapshot)
{
    const size_t count = neighbours_count(neighbours);
    double *values = mem_array(count, sizeof(*values));
    struct neighbour *out = mem_array(count, sizeof(*out));
    for (size_t i = 0; i < count; i++) {
        const struct reading *reading = &snapshot->readings[neighbours_tag(neighbours, i)];
        values[i] = quality_is_bad(reading->quality) ? (double)NAN : reading->value;
    }
    neighbours_predict(neighbours, values, out);
    mem_free(values);
    return out;
}

const struct neighbours_kept *neighbours_look(struct neighbours_cache *cache, const struct scene *scene, int asset, int group,
                                              const struct snapshot *snapshot)
{
    const size_t groups = scene->plant->group_count;
    if (!cache->kept) {
        cache->count = scene->asset_count * groups;
        cache->kept = mem_array(cache->count, sizeof(*cache->kept));
    }
    struct neighbours_kept *kept = &cache->kept[(size_t)asset * groups + (size_t)group];
    if (kept->taken_mono_ns && snapshot->taken_mono_ns - kept->taken_mono_ns < NEIGHBOURS_FRESH_NS)
        return kept;
    if (!kept->taken_mono_ns)
        kept->of = neighbours_create(scene, asset, group);
    mem_free(kept->list);
    kept->list = kept->of ? predict_from(kept->of, snapshot) : NULL;
    kept->count = kept->of ? neighbours_count(kept->of) : 0;
    kept->taken_mono_ns = snapshot->taken_mono_ns;
    kept->taken_utc_ns = snapshot->taken_utc_ns;
    return kept;
}

void neighbours_cache_finish(struct neighbours_cache *cache)
{
    for (size_t i = 0; i < cache->count; i++) {
        neighbours_destroy(&cache->kept[i].of);
        mem_free(cache->kept[i].list);
    }
    mem_free(cache->kept);
    *cache = (struct neighbours_cache){ 0 };
}

double neighbour_off(const struct plant *plant, const struct neighbour *neighbour)
{
    const struct plant_group *group = &plant->groups[plant->tags[neighbour->tag].group];
    double step = isnan(neighbour->deviation) ? PLANT_SEEN_PART * (group->max - group->min) : neighbour->deviation;
    return (neighbour->value - neighbour->predicted) / step;
}
