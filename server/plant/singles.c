/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds assets on which a group (sensors of one quantity) has a single sensor. */
#include "plant/singles.h"

#include "base/mem.h"
#include "plant/influence.h"

/* `paper` is not measured for more sensors than this: each sensor then has so small a weight that its errors are usually far
   below those of `shepard`. */
#define MANY 64

bool plant_cuts_singles(const struct plant_group *group)
{
    return group->interpolation == INTERPOLATION_PAPER || plant_prepares(group, INTERPOLATION_FIN) ||
           plant_prepares(group, INTERPOLATION_GP) || group->cuts_singles;
}

bool plant_cuts_for_paper(const struct plant_group *group, size_t sensor_count)
{
    return sensor_count <= MANY && (sensor_count > 1 || plant_cuts_singles(group));
}

size_t plant_singles(const struct plant *plant, int group, int *first)
{
    size_t *sensors = mem_array(plant->asset_count, sizeof(*sensors)), count = 0;
    for (size_t i = 0; i < plant->tag_count; i++)
        if (plant->tags[i].group == group && plant->tags[i].asset >= 0 && !plant->tags[i].place.assumed)
            sensors[plant->tags[i].asset]++;
    for (size_t a = 0; a < plant->asset_count; a++)
        if (sensors[a] == 1 && count++ == 0)
            *first = (int)a;
    mem_free(sensors);
    return count;
}

bool plant_is_single(const struct plant *plant, int tag)
{
    const struct plant_tag *of = &plant->tags[tag];
    for (size_t i = 0; i < plant->tag_count; i++)
        if ((int)i != tag && plant->tags[i].group == of->group && plant->tags[i].asset == of->asset && !plant->tags[i].place.assumed)
            return false;
    return of->group >= 0 && of->asset >= 0;
}
