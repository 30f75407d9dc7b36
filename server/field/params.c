/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a session may choose: defaults from the group, and the ranges. */
#include <math.h>
#include <string.h>

#include "field/field.h"

void field_params_default(const struct plant *plant, int group, struct field_params *params)
{
    const struct plant_group *from = &plant->groups[group];
    *params = (struct field_params){
        .group = group,
        .interpolation = from->interpolation,
        .distance = from->distance,
        .fill = from->fill,
        .strength = 1,
        .decay = 1,
        .power = from->power,
        .radius_m = from->radius_m,
        .reach_m = from->reach_m,
    };
}

bool field_params_equal(const struct field_params *a, const struct field_params *b)
{
    return memcmp(a, b, sizeof(*a)) == 0;
}

static bool within(double x, double low, double high)
{
    return x >= low && x <= high;
}

const char *field_params_wrong(const struct plant *plant, const struct field_params *params)
{
    if (params->group < 0 || (size_t)params->group >= plant->group_count)
        return "group: unknown";
    if (params->interpolation != INTERPOLATION_SHEPARD && params->interpolation != INTERPOLATION_PAPER)
        return "interpolation: expected shepard or paper";
    if (params->distance != DISTANCE_GEODESIC && params->distance != DISTANCE_EUCLIDEAN)
        return "distance: expected geodesic or euclidean";
    if (params->fill != FILL_NONE && params->fill != FILL_NEIGHBOURS)
        return "fill: expected none or neighbours";
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
