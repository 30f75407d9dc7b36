/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parameters of a field: defaults from the group, overrides for single sensors, checks, and default ranges. */
#include "field/params.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "field/kernels.h"
#include "protocol/asset_distance.h"
#include "field/limits.h"
#include "plant/influence.h"

/* end of the colour scale in views of differences: from minus to plus this fraction of the group's range */
static const double DIFFERENCE_PART = 0.25;

void field_params_default(const struct plant *plant, int group, struct field_params *params)
{
    const struct plant_group *from = &plant->groups[group];
    memset(params, 0, sizeof(*params));
    params->group = group;
    params->sensor = -1;
    params->interpolation = from->interpolation;
    params->distance = from->distance;
    params->fill = from->fill;
    params->strength = params->decay = 1;
    params->power = from->power;
    params->radius_m = from->radius_m;
    params->reach_m = from->reach_m;
}

void field_params_set_show(const struct plant *plant, struct field_params *params, enum field_show show)
{
    bool has_harmonic = plant_prepares(&plant->groups[params->group], INTERPOLATION_HARMONIC);
    params->show = show;
    if (show == SHOW_OPERATOR && params->interpolation == INTERPOLATION_FIN)
        params->interpolation = has_harmonic ? INTERPOLATION_HARMONIC : INTERPOLATION_SHEPARD;
    if (show == SHOW_UNCERTAINTY && plant_prepares(&plant->groups[params->group], INTERPOLATION_GP))
        params->interpolation = INTERPOLATION_GP;
}

bool field_params_cover(const struct field_params *params)
{
    return params->show == SHOW_UNCERTAINTY || params->show == SHOW_BLIND;
}

enum distance_mode field_params_distance(const struct field_params *params)
{
    return params->show == SHOW_DISTANCE ? params->distance : interpolation_distance(params->interpolation, params->distance);
}

bool field_params_equal(const struct field_params *a, const struct field_params *b)
{
    return memcmp(a, b, offsetof(struct field_params, overrides)) == 0 &&
           memcmp(a->overrides, b->overrides, a->override_count * sizeof(*a->overrides)) == 0;
}

/* --- overrides ------------------------------------------------------------------------------------------------------------- */

static int by_tag(const void *a, const void *b)
{
    const struct field_override *first = a, *second = b;
    return (first->tag > second->tag) - (first->tag < second->tag);
}

const struct field_override *field_params_override_of(const struct field_params *params, int tag)
{
    struct field_override key = { .tag = tag };
    return bsearch(&key, params->overrides, params->override_count, sizeof(key), by_tag);
}

static void drop_override(struct field_params *params, size_t at)
{
    size_t after = params->override_count - at - 1;
    memmove(&params->overrides[at], &params->overrides[at + 1], after * sizeof(*params->overrides));
    memset(&params->overrides[--params->override_count], 0, sizeof(*params->overrides));
}

bool field_params_override(struct field_params *params, struct field_override override)
{
    bool nothing = override.strength < 0 && override.decay < 0;
    const struct field_override *old = field_params_override_of(params, override.tag);
    if (old && nothing)
        drop_override(params, (size_t)(old - params->overrides));
    else if (old)
        params->overrides[old - params->overrides] = override;
    if (old || nothing)
        return true;
    if (params->override_count == FIELD_OVERRIDES)
        return false;
    params->overrides[params->override_count++] = override;
    qsort(params->overrides, params->override_count, sizeof(override), by_tag);
    return true;
}

/* --- ranges ---------------------------------------------------------------------------------------------------------------- */

static float largest_distance(const struct asset_view *view, size_t column, enum distance_mode mode)
{
    size_t count = view->header->vertex_count;
    float most_m = 0, scratch[KERNEL_BLOCK];
    for (size_t at = 0; at < count; at += KERNEL_BLOCK) {
        size_t number = count - at < KERNEL_BLOCK ? count - at : KERNEL_BLOCK;
        /* uses the asset file's distances along triangles even for views of heat-method distances: both get the same colour
           range, so that their pictures can be compared */
        if (mode != DISTANCE_EUCLIDEAN)
            kernel_distances(asset_distance_codes(view, column, at), number, scratch);
        else
            kernel_euclidean(view->positions_m + at, number, view->sensors[column].surface_m, scratch);
        most_m = kernel_largest(scratch, number, most_m);
    }
    return most_m;
}

/* Rounds a range of values up so that the third significant digit becomes 0 or 5: 16.375 becomes 16.5. */
static double rounded_up(double most_m)
{
    double step = 0.5 * pow(10, floor(log10(most_m)) - 1);
    return ceil(most_m / step - 1e-6) * step;
}

static double distance_range(const struct scene *scene, const struct field_params *params)
{
    for (size_t a = 0; a < scene->asset_count; a++)
        for (size_t i = 0; i < scene->assets[a].sensor_count; i++) {
            const struct scene_sensor *sensor = &scene->assets[a].sensors[i];
            if (sensor->tag != params->sensor)
                continue;
            float most_m = largest_distance(&scene->assets[a].file->view, (size_t)sensor->column, params->distance);
            return most_m > 1e-6f ? rounded_up((double)most_m) : 1;
        }
    return 1;
}

/* Returns the largest standard deviation, over all assets, of the prior of interpolation gp (Gaussian process). A prior that
   preparation fitted differs by asset. */
static double deviation_range(const struct scene *scene, int group)
{
    const double stated = scene->plant->groups[group].gp.deviation;
    double most = isnan(stated) ? 0 : stated;
    for (size_t a = 0; a < scene->asset_count; a++) {
        const struct influence_entry *entry =
            scene->assets[a].file ? influence_find(&scene->assets[a].file->influence, (uint32_t)group, INTERPOLATION_GP) : NULL;
        most = entry ? fmax(most, entry->deviation) : most;
    }
    return most > 0 ? rounded_up(most) : 1;
}

void field_default_range(const struct scene *scene, const struct field_params *params, double *min, double *max)
{
    const struct plant_group *group = &scene->plant->groups[params->group];
    double part = DIFFERENCE_PART * (group->max - group->min);
    switch (params->show) {
    case SHOW_VALUE: *min = group->min, *max = group->max; break;
    case SHOW_DISTANCE: *min = 0, *max = distance_range(scene, params); break;
    case SHOW_DIFFERENCE: *min = -part, *max = part; break;
    case SHOW_UNCERTAINTY: *min = 0, *max = deviation_range(scene, params->group); break;
    case SHOW_BLIND: *min = PLANT_SEEN_PART * (group->max - group->min), *max = group->max - group->min; break;
    case SHOW_OPERATOR: *min = -LIMIT_PLACE_MOST, *max = LIMIT_PLACE_MOST; break;
    }
}

static bool within(double x, double low, double high)
{
    return x >= low && x <= high;
}

static const char *numbers_wrong(const struct field_params *params)
{
    if (!within(params->strength, 0, 100))
        return "strength: expected 0..100";
    if (!within(params->decay, 0, 100))
        return "decay: expected 0..100";
    if (!within(params->power, 0.5, 16))
        return "power: expected 0.5..16";
    if (params->radius_m != 0 && !within(params->radius_m, 1e-3, 1e6))
        return "radius_m: expected 0 (automatic) or 0.001..1000000";
    if (!(params->reach_m > 0))
        return "reach_m: expected more than 0";
    return NULL;
}

static bool of_group(const struct plant *plant, const struct field_params *params, int tag)
{
    return tag >= 0 && (size_t)tag < plant->tag_count && plant->tags[tag].group == params->group && plant->tags[tag].asset >= 0;
}

bool field_params_placed(const struct plant *plant, const struct field_params *params)
{
    bool placed = params->sensor < 0 || of_group(plant, params, params->sensor);
    for (size_t i = 0; i < params->override_count; i++)
        placed = placed && of_group(plant, params, params->overrides[i].tag);
    return placed;
}

static const char *sensors_wrong(const struct plant *plant, const struct field_params *params)
{
    if (params->show == SHOW_DISTANCE && params->sensor < 0)
        return "sensor: expected a sensor, because show is distance";
    if (!field_params_placed(plant, params))
        return "sensors: a listed sensor belongs to another group, or has no position on an asset";
    if (params->show == SHOW_DIFFERENCE && params->baseline == 0)
        return "baseline: expected a baseline, because show is difference";
    for (size_t i = 0; i < params->override_count; i++) {
        const struct field_override *o = &params->overrides[i];
        if ((o->strength != FIELD_AS_CONFIGURED && !within((double)o->strength, 0, 100)) ||
            (o->decay != FIELD_AS_CONFIGURED && !within((double)o->decay, 0, 100)))
            return "sensors: expected a strength and a decay from 0 to 100";
    }
    return NULL;
}

const char *field_params_wrong(const struct plant *plant, const struct field_params *params)
{
    if (params->group < 0 || (size_t)params->group >= plant->group_count)
        return "group: unknown";
    if ((unsigned)params->interpolation >= INTERPOLATIONS)
        return "interpolation: expected shepard, paper, harmonic, fin or gp";
    if (interpolation_is_prepared(params->interpolation) && !plant_prepares(&plant->groups[params->group], params->interpolation))
        return "interpolation: not prepared for the displayed group; add the interpolation to the group's 'prepare' in the plant file";
    if ((unsigned)params->distance >= DISTANCES)
        return "distance: expected geodesic, euclidean or heat";
    if (params->distance == DISTANCE_HEAT && !plant->groups[params->group].heat)
        return "distance: heat is not prepared for the displayed group; set 'geodesic: heat' for the group in the plant file";
    if (params->fill != FILL_NONE && params->fill != FILL_NEIGHBOURS)
        return "fill: expected none or neighbours";
    if ((unsigned)params->show > SHOW_BLIND)
        return "show: expected value, distance, difference, operator, uncertainty or blind";
    if (params->show == SHOW_UNCERTAINTY && params->interpolation != INTERPOLATION_GP)
        return "show: uncertainty needs the interpolation 'gp'; choose 'gp', and add 'gp' to the group's 'prepare' in the plant file";
    if (params->show == SHOW_OPERATOR && params->interpolation == INTERPOLATION_FIN)
        return "interpolation: fin does not support show operator; choose another interpolation";
    const char *wrong = numbers_wrong(params);
    return wrong ? wrong : sensors_wrong(plant, params);
}
