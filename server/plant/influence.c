/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a group asks to be prepared, and what that needs. */
#include "plant/influence.h"

#include <math.h>
#include <string.h>

#include "plant/plant_impl.h"

double plant_decay_m(const struct plant_asset *asset)
{
    return sqrt(asset->conductivity * asset->thickness_m / asset->heat_transfer);
}

void plant_influence_read(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    static const char *const names[INTERPOLATIONS] = { [INTERPOLATION_HARMONIC] = "harmonic", [INTERPOLATION_FIN] = "fin" };
    struct plant_group *group = record;
    int count = yaml_list_count(reader, node, "prepare");
    for (int i = 0; i < count; i++) {
        yaml_node_t *item = yaml_list_item(reader, node, i);
        const char *text = yaml_text(item);
        int found = INTERPOLATION_HARMONIC;
        while (text && found < INTERPOLATIONS && strcmp(text, names[found]) != 0)
            found++;
        if (!text || found == INTERPOLATIONS)
            yaml_expected(reader, item, "prepare", "harmonic or fin");
        else
            group->prepared |= 1u << found;
    }
}

static bool has_sensor(const struct plant *plant, int group, int asset)
{
    for (size_t i = 0; i < plant->tag_count; i++)
        if (plant->tags[i].group == group && plant->tags[i].asset == asset && !plant->tags[i].place_assumed)
            return true;
    return false;
}

void plant_influence_check(const struct plant *plant, struct diag *diag)
{
    for (size_t g = 0; g < plant->group_count; g++) {
        const struct plant_group *group = &plant->groups[g];
        if (!plant_prepares(group, INTERPOLATION_FIN))
            continue;
        if (isnan(group->ambient))
            diag_error(diag, plant->path, group->line, 0,
                       "group %s: fin needs 'ambient', what is around the assets, in %s: far from sensors the wall cools down to it",
                       group->id, *group->unit ? group->unit : "the group's unit");
        for (size_t a = 0; a < plant->asset_count; a++)
            if (plant->assets[a].thickness_m <= 0 && has_sensor(plant, (int)g, (int)a))
                diag_error(diag, plant->path, plant->assets[a].line, 0,
                           "asset %s: fin, which group %s asks for, needs 'thickness_m', that of its wall", plant->assets[a].id, group->id);
    }
}
