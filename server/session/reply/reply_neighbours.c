/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds the JSON answer of /api/v1/neighbours: a group's sensors on all assets, each with the estimate from its neighbouring sensors. */
#include "session/reply/reply_neighbours.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "base/text/json_text.h"
#include "message/json_values.h"
#include "message/names.h"
#include "session/reply/reply_impl.h"

struct disagreement {
    struct neighbour neighbour;
    double off;
};

static int by_disagreement(const void *a, const void *b)
{
    const struct disagreement *first = a, *second = b;
    double x = isnan(first->off) ? -1 : fabs(first->off), y = isnan(second->off) ? -1 : fabs(second->off);
    return (x < y) - (x > y);
}

static json_t *disagreement_of(const struct plant *plant, const struct disagreement *of)
{
    const struct neighbour *n = &of->neighbour;
    return json_pack("{s:o,s:o,s:o,s:o,s:o,s:o,s:o}", "tag", string(plant->tags[n->tag].name), "by",
                     string(name_of(names_interpolation, n->by)), "value", number(n->value), "predicted", number(n->predicted), "residual",
                     number(n->value - n->predicted), "deviation", number(n->deviation), "off", number(of->off));
}

char *neighbour_text(struct neighbour_text_cache *cache, const struct session_context *context, int group, int tag)
{
    const struct plant *plant = context->plant;
    json_t *list = json_array();
    struct disagreement *all = NULL;
    size_t count = 0, capacity = 0;
    int64_t utc_ns = context->readings.snapshot->taken_utc_ns;
    for (size_t a = 0; a < context->services->scene->asset_count; a++) {
        if (tag >= 0 && plant->tags[tag].asset != (int)a)
            continue;
        const struct neighbours_kept *found =
            neighbours_look(&cache->found, context->services->scene, (int)a, group, context->readings.snapshot);
        mem_grow(&all, &capacity, count + found->count + 1, sizeof(*all));
        for (size_t i = 0; i < found->count; i++)
            if (tag < 0 || found->list[i].tag == tag)
                all[count++] = (struct disagreement){ found->list[i], neighbour_off(plant, &found->list[i]) };
        utc_ns = found->count > 0 && found->taken_utc_ns < utc_ns ? found->taken_utc_ns : utc_ns;
    }
    qsort(all, count, sizeof(*all), by_disagreement);
    for (size_t i = 0; i < count; i++)
        json_array_append_new(list, disagreement_of(plant, &all[i]));
    mem_free(all);
    json_t *object = json_pack("{s:I,s:o,s:o,s:o}", "time_us", us(utc_ns), "group", string(plant->groups[group].id), "unit",
                               string(plant->groups[group].unit), "sensors", list);
    return json_text(object, DIGITS);
}

void neighbour_text_cache_finish(struct neighbour_text_cache *cache)
{
    neighbours_cache_finish(&cache->found);
}
