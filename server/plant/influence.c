/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads which interpolations plantcast-prep must prepare for a group of tags, and checks their parameters. */
#include "plant/influence.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "plant/plant_impl.h"

double plant_decay_m(const struct plant_asset *asset)
{
    return sqrt(asset->conductivity * asset->thickness_m / asset->heat_transfer);
}

void plant_influence_read(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    static const char *const names[INTERPOLATIONS] = {
        [INTERPOLATION_HARMONIC] = "harmonic", [INTERPOLATION_FIN] = "fin", [INTERPOLATION_GP] = "gp"
    };
    struct plant_group *group = record;
    int count = yaml_list_count(reader, node, "prepare");
    for (int i = 0; i < count; i++) {
        yaml_node_t *item = yaml_list_item(reader, node, i);
        const char *text = yaml_text(item);
        int found = INTERPOLATION_HARMONIC;
        while (text && found < INTERPOLATIONS && strcmp(text, names[found]) != 0)
            found++;
        if (!text || found == INTERPOLATIONS)
            yaml_expected(reader, item, "prepare", "harmonic, fin or gp");
        else
            group->prepared |= 1u << found;
    }
}

void plant_gp_read(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    static const struct yaml_key keys[] = {
        { "range_m", KEY_NUMBER, false, offsetof(struct plant_gp, range_m), 1e-3, 1e6, NULL, NULL },
        { "noise", KEY_NUMBER, false, offsetof(struct plant_gp, noise), 0, PLANT_MAX_VALUE, NULL, NULL },
        { "deviation", KEY_NUMBER, false, offsetof(struct plant_gp, deviation), 1e-12, PLANT_MAX_VALUE, NULL, NULL },
        { "fit", KEY_NAME, false, offsetof(struct plant_gp, fit), 0, 0, NULL, NULL },
        { 0 }
    };
    struct plant_group *group = record;
    struct yaml_map map;
    yaml_map_read(reader, node, "gp", keys, &group->gp, &map);
}

void plant_gp_defaults(const struct plant_group *group, double *noise, double *deviation)
{
    const double range = group->max - group->min;
    *noise = isnan(*noise) ? PLANT_GP_NOISE * range : *noise;
    *deviation = isnan(*deviation) ? PLANT_GP_DEVIATION * range : *deviation;
}

/* Sets defaults for the interpolation `gp` if the plant file names no file of readings from which plantcast-prep can determine
   the parameters. */
void plant_gp_check(struct yaml_reader *reader, const struct yaml_map *map, const struct plant *plant, struct plant_group *group)
{
    struct plant_gp *gp = &group->gp;
    if (gp->fit) {
        plant_resolve_path(plant, &gp->fit);
        return;
    }
    plant_gp_defaults(group, &gp->noise, &gp->deviation);
    if (plant_prepares(group, INTERPOLATION_GP) && isnan(gp->range_m))
        yaml_error(reader, yaml_map_place(map, "gp"),
                   "group %s: gp requires 'gp: { range_m: ... }' (correlation length in metres) or 'fit' (a file of readings)",
                   group->id ? group->id : "");
}

static int count_sensors(const struct plant *plant, int group, int asset)
{
    int count = 0;
    for (size_t i = 0; i < plant->tag_count; i++)
        count += plant->tags[i].group == group && plant->tags[i].asset == asset && !plant->tags[i].place.assumed;
    return count;
}

/* Warns of assets with too few sensors of a group to determine the parameters of `gp` from readings. */
static void warn_of_fits(const struct plant *plant, int g, struct diag *diag)
{
    const struct plant_group *group = &plant->groups[g];
    const struct plant_gp *gp = &group->gp;
    if (!plant_prepares(group, INTERPOLATION_GP) || !gp->fit || !(isnan(gp->range_m) || isnan(gp->noise) || isnan(gp->deviation)))
        return;
    for (size_t a = 0; a < plant->asset_count; a++) {
        int count = count_sensors(plant, g, (int)a);
        if (count > 0 && count < PLANT_GP_FITTED)
            diag_warning(diag, plant->files.path, group->line, 0,
                         "group %s: gp cannot be fitted on asset %s, which has %d sensors but needs at least %d: the asset uses the "
                         "default parameters",
                         group->id, plant->assets[a].id, count, PLANT_GP_FITTED);
    }
}

void plant_influence_check(const struct plant *plant, struct diag *diag)
{
    for (size_t g = 0; g < plant->group_count; g++) {
        const struct plant_group *group = &plant->groups[g];
        warn_of_fits(plant, (int)g, diag);
        if (!plant_prepares(group, INTERPOLATION_FIN))
            continue;
        if (isnan(group->ambient))
            diag_error(diag, plant->files.path, group->line, 0,
                       "group %s: fin requires 'ambient', the value around the assets, in %s: far from sensors, the asset's metal wall "
                       "takes this value",
                       group->id, *group->unit ? group->unit : "the group's unit");
        for (size_t a = 0; a < plant->asset_count; a++)
            if (plant->assets[a].thickness_m <= 0 && count_sensors(plant, (int)g, (int)a) > 0)
                diag_error(diag, plant->files.path, plant->assets[a].line, 0,
                           "asset %s: group %s has 'interpolation: fin', which requires 'thickness_m', the thickness of the asset's "
                           "metal wall",
                           plant->assets[a].id, group->id);
    }
}
