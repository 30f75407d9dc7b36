/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds possible problems to list in the report on preparing a plant. */
#include <stdlib.h>

#include "base/mem.h"
#include "plant/exact.h"
#include "plant/models/asset_size.h"
#include "preprocess/report/report.h"
#include "preprocess/subdivision/subdivide.h"
#include "preprocess/report/text_table.h"

/* an asset is reported if the root mean square difference between its distances and the heat method's exceeds this, relative to
 * the largest distance; smaller differences come from the heat method, which smooths distances */
#define METHODS_DIFFER 0.05
/* an interpolation error that exceeds subdivision's limit by more than this factor is reported; above 1 because of
   single-precision rounding */
#define FIELD_SLACK 1.05
/* an asset is reported if the error of interpolation inside triangles ("bend") is too large or unknown on more than this share
   of its surface */
#define BENT_SHARE 1e-3

const char *const report_states[] = { "left", "failed", "unchanged", "shared", "built" };

uint32_t report_added(const struct prepare_asset *asset)
{
    return asset->vertices > asset->report.vertices ? asset->vertices - asset->report.vertices : 0;
}

struct concerns {
    struct report_concern *at;
    size_t count, capacity;
};

static void add_concern(struct concerns *concerns, const struct prepare_asset *asset, double weight, char *text)
{
    mem_grow(&concerns->at, &concerns->capacity, concerns->count + 1, sizeof(*concerns->at));
    concerns->at[concerns->count++] = (struct report_concern){ .asset = asset, .text = text, .weight = weight };
}

static void add_sensors(struct concerns *concerns, const struct prepare *prepare, const struct prepare_asset *asset)
{
    for (size_t s = 0; asset->surface_distances_m && s < asset->sensor_count; s++) {
        double distance_m = (double)asset->surface_distances_m[s];
        const struct plant_tag *tag = &prepare->plant->tags[asset->sensors[s].tag];
        if (distance_m > asset->far_m && !tag->place.assumed)
            add_concern(concerns, asset, 1000 + distance_m / asset->far_m,
                        mem_printf("sensor %s is %.3f m from the surface of the asset (limit: %.3f m)", tag->name, distance_m,
                                   asset->far_m));
    }
}

static void add_numbers(struct concerns *concerns, const struct prepare_asset *asset)
{
    const struct build_report *r = &asset->report;
    if (r->stray[0])
        add_concern(concerns, asset, 1e5, mem_strdup(r->stray));
    if (r->unreachable_vertices > r->surface.hidden_vertices) {
        double share = (double)r->unreachable_vertices / (double)(r->vertices ? r->vertices : 1);
        add_concern(concerns, asset, 100 * (1 + share),
                    mem_printf("no sensor reaches %s of the asset's %s vertices (%.1f %%); the surface is in %zu pieces",
                               text_table_number(r->unreachable_vertices).text, text_table_number(r->vertices).text, 100 * share,
                               r->surface.components_after));
    }
    if (r->surface.heat_disagreement > METHODS_DIFFER)
        add_concern(
            concerns, asset, 10 * (1 + r->surface.heat_disagreement),
            mem_printf(
                "two methods of measuring distances on the asset differ by %.1f %%: its surface may be torn, or joined in wrong places",
                100 * r->surface.heat_disagreement));
    const struct level_left *left = &r->levels[0].left[LEVEL_LIMIT_TRIANGLES];
    if (r->level_count && (double)left->steps > FIELD_SLACK)
        add_concern(concerns, asset, 1 + (double)left->steps / 255,
                    mem_printf("in close views, values err by up to %.1f steps of colour (1/255 of the range) along %s edge%s, because the "
                               "asset has reached its limit of triangles",
                               (double)left->steps, text_table_number(left->edges).text, left->edges == 1 ? "" : "s"));
}

/* Reports the bend (interpolation error inside triangles) of the fields harmonic, fin and gp. Subdivision refines triangles
 * only for fields with distance weights, not for these. */
static void add_bend(struct concerns *concerns, const struct prepare_asset *asset)
{
    const struct bend_report *bend = &asset->report.bend;
    if (bend->over_share > BENT_SHARE)
        add_concern(
            concerns, asset, 1 + bend->steps / 255,
            mem_printf("inside triangles, the interpolations harmonic, fin or gp may err by over a step of colour (1/255 of the range) on "
                       "%.3g %% of the asset's surface, by up to %.1f steps",
                       100 * bend->over_share, bend->steps));
    if (bend->unmeasured > 0 || bend->unknown_share > BENT_SHARE)
        add_concern(
            concerns, asset, 1,
            mem_printf("the error of the interpolations harmonic, fin or gp inside triangles is unknown on %.3g %% of the asset's surface",
                       bend->unmeasured > 0 ? 100 : 100 * bend->unknown_share));
}

/* Reports high powers of inverse distance weights, which amplify distance errors (plant/exact.h). */
static void add_powers(struct concerns *concerns, const struct prepare *prepare, const struct prepare_asset *asset)
{
    for (size_t g = 0; g < prepare->plant->group_count; g++) {
        const struct plant_group *group = &prepare->plant->groups[g];
        double steps = 255 * PLANT_DISTANCE_ERROR * group->power / 2;
        size_t sensors = plant_placed_sensors(prepare->plant, asset->sensors, asset->sensor_count, (int)g, NULL);
        if (sensors > 1 && group->interpolation == INTERPOLATION_SHEPARD && group->power >= PLANT_HIGH_POWER)
            add_concern(
                concerns, asset, 1 + steps / 255,
                mem_printf("values of group '%s' on the surface may err by up to %.0f steps of colour (1/255 of the range): power %g "
                           "amplifies distance errors of %.1f %%",
                           group->id, steps, group->power, 100 * PLANT_DISTANCE_ERROR));
    }
}

/* Reports doubtful sizes of assets, which may be due to a wrong unit. Includes assets not built in this run, because a wrong
 * unit remains an error until somebody corrects it. */
static void add_sizes(struct concerns *concerns, const struct prepare *prepare)
{
    double *longest_m = mem_array(prepare->asset_count, sizeof(*longest_m));
    size_t count = 0;
    for (size_t i = 0; i < prepare->asset_count; i++)
        if (asset_longest_m(prepare->assets[i].size_m) > 0)
            longest_m[count++] = asset_longest_m(prepare->assets[i].size_m);
    double median_m = asset_median_m(longest_m, count);
    for (size_t i = 0; i < prepare->asset_count; i++) {
        const struct prepare_asset *asset = &prepare->assets[i];
        char why[SIZE_WHY_BYTES];
        /* true: the asset is large because of pieces far from its main part, which the report lists as a separate problem */
        bool stray = asset->reported && asset->report.stray[0];
        if (!stray && asset_longest_m(asset->size_m) > 0 && asset_size_doubtful(asset->plant, asset->size_m, median_m, why))
            add_concern(concerns, asset, 1e6, mem_strdup(why));
    }
    mem_free(longest_m);
}

int report_concern_compare(const void *a, const void *b)
{
    const struct report_concern *p = a, *q = b;
    if (p->weight != q->weight)
        return p->weight > q->weight ? -1 : 1;
    return p->asset < q->asset ? -1 : p->asset > q->asset;
}

struct report_concern *report_concerns(const struct prepare *prepare, size_t *count)
{
    struct concerns concerns = { 0 };
    for (size_t i = 0; i < prepare->asset_count; i++) {
        const struct prepare_asset *asset = &prepare->assets[i];
        if (asset->wanted && asset->state == PREPARE_FAILED)
            add_concern(&concerns, asset, 1e9, mem_strdup("the asset could not be prepared: see the errors"));
        add_sensors(&concerns, prepare, asset);
        if (asset->reported && asset->state != PREPARE_SHARED)
            add_numbers(&concerns, asset), add_bend(&concerns, asset);
        if (asset->wanted && asset->state != PREPARE_SHARED)
            add_powers(&concerns, prepare, asset);
    }
    add_sizes(&concerns, prepare);
    if (concerns.count)
        qsort(concerns.at, concerns.count, sizeof(*concerns.at), report_concern_compare);
    *count = concerns.count;
    return concerns.at;
}

void report_concerns_free(struct report_concern *concerns, size_t count)
{
    for (size_t i = 0; i < count; i++)
        mem_free(concerns[i].text);
    mem_free(concerns);
}
