/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes a frame plan: first culls assets and chooses the light set and levels of detail. Then computes the fields at as many
   vertices as those levels need. */
#include "render/plan/frame_planner.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "render/pick/isolines.h"
#include "render/plan/content_hash.h"
#include "render/plan/lod_selection.h"

struct light_key frame_plan_wanted_light(const struct view *view)
{
    struct light_key key = { .environment = view->environment, .shown = view->visibility };
    memcpy(key.towards, view->light_dir, sizeof(key.towards));
    return key;
}

static int by_distance(const void *a, const void *b, void *distance_m)
{
    const double *d = distance_m;
    double first = d[*(const int *)a], second = d[*(const int *)b];
    return (first > second) - (first < second);
}

/* Returns whether any part of the asset is drawn normally: it is neither hidden nor drawn as an outline only (ghosted), and
   section planes do not cut it away entirely. */
static bool is_left(const struct visibility *visibility, int index, const struct scene_asset *asset)
{
    return visibility_of(visibility, index) == ASSET_SHOWN && !clip_drops(&visibility->clip, asset->bounds_min_m, asset->bounds_max_m);
}

/* Lists the assets in the frustum, nearest first, so that hidden fragments fail the depth test early. */
static void find_visible(struct frame_plan *plan)
{
    const struct scene *scene = plan->gpu_scene->scene;
    double *distance_m = mem_array(scene->asset_count, sizeof(*distance_m));
    for (size_t i = 0; i < scene->asset_count; i++) {
        const struct scene_asset *asset = &scene->assets[i];
        double square = 0;
        if (!view_constants_sees(&plan->constants, asset) || !is_left(&plan->view.visibility, (int)i, asset))
            continue;
        for (int c = 0; c < 3; c++) {
            double by =
                fmax(fabs(asset->bounds_min_m[c] - plan->constants.eye_m[c]), fabs(asset->bounds_max_m[c] - plan->constants.eye_m[c]));
            square += by * by;
        }
        distance_m[i] = sqrt(square);
        plan->visible[plan->visible_count++] = (int)i;
    }
    qsort_r(plan->visible, plan->visible_count, sizeof(*plan->visible), by_distance, distance_m);
    mem_free(distance_m);
}

static struct light_key choose_light(const struct frame_planner *planner, const struct view *view)
{
    struct light_key key = frame_plan_wanted_light(view);
    const struct light_set *near = view->tier == TIER_PREVIEW && planner->near_light ? light_near(planner->light, &key) : NULL;
    return near ? near->key : key;
}

/* Returns how many of the asset's vertices, counted from the first in the file, need field values for surface, isoline labels
   and arrows. */
static size_t count_vertices(const struct frame_plan *plan, int asset)
{
    double lines[VIEW_ALL_LINES];
    size_t count = lod_level(plan->gpu_scene, &plan->constants, asset, plan->error_px)->vertex_count;
    size_t labels = view_lines(&plan->view, lines) > 0 ? isolines_vertex_count(&plan->gpu_scene->scene->assets[asset]) : 0;
    bool has_arrows = isolines_has_arrows(plan->gpu_scene->scene, &plan->view);
    size_t arrows = has_arrows ? arrows_vertex_count(&plan->gpu_scene->scene->assets[asset]) : 0;
    count = count > labels ? count : labels;
    return count > arrows ? count : arrows;
}

struct frame_plan *frame_plan_create(const struct frame_planner *planner, const struct view *view)
{
    const struct scene *scene = planner->gpu_scene->scene;
    struct frame_plan *plan = mem_new(sizeof(*plan));
    plan->gpu_scene = planner->gpu_scene;
    plan->view = *view;
    plan->visible = mem_array(scene->asset_count, sizeof(*plan->visible));
    plan->vertex_counts = mem_array(scene->asset_count, sizeof(*plan->vertex_counts));
    plan->fields = mem_array(scene->asset_count, sizeof(*plan->fields));
    plan->lit_by = choose_light(planner, view);
    view_constants_init(&plan->constants, view, scene);
    find_visible(plan);
    if (!planner->finest)
        plan->error_px = lod_error_px(&(struct lod_params){ .gpu_scene = plan->gpu_scene,
                                                            .constants = &plan->constants,
                                                            .tier = view->tier,
                                                            .visible = plan->visible,
                                                            .visible_count = plan->visible_count });
    for (size_t i = 0; i < plan->visible_count; i++)
        plan->vertex_counts[i] = count_vertices(plan, plan->visible[i]);
    return plan;
}

void frame_plan_destroy(struct frame_plan **plan)
{
    if (!*plan)
        return;
    mem_free((*plan)->visible);
    mem_free((*plan)->vertex_counts);
    mem_free((*plan)->fields);
    mem_free(*plan);
    *plan = NULL;
}

bool frame_plan_prepare(struct frame_plan *plan, const struct frame_planner *planner, const struct snapshot *snapshot, int64_t budget_ns)
{
    static const double slice = 1e6;
    int64_t begin_ns = clock_mono_ns();
    bool ready = true;
    if (budget_ns == INT64_MAX)
        /* computes the fields here only if there is a time limit; otherwise frame_plan_complete() later computes the fields of
           many assets in parallel */
        return true;
    for (size_t i = 0; i < plan->visible_count && ready && plan->view.look != LOOK_MATERIALS; i++) {
        size_t count = fields_vertices(planner->fields, plan->visible[i], &plan->view.field, plan->vertex_counts[i]);
        while (ready && !field_advance(planner->fields->field, plan->visible[i], &plan->view.field, snapshot, count, slice))
            ready = clock_mono_ns() - begin_ns < budget_ns;
    }
    plan->field_ns += clock_mono_ns() - begin_ns;
    return ready;
}

void frame_plan_complete(struct frame_plan *plan, const struct frame_planner *planner, const struct snapshot *snapshot)
{
    int64_t begin_ns = clock_mono_ns();
    struct scale scale;
    view_scale(planner->gpu_scene->scene->plant, &plan->view, &scale);
    fields_trim(planner->fields);
    if (plan->view.look != LOOK_MATERIALS)
        fields_get(planner->fields,
                   &(struct fields_ask){ .assets = plan->visible,
                                         .counts = plan->vertex_counts,
                                         .asset_count = plan->visible_count,
                                         .params = &plan->view.field,
                                         .step = scale_step(&scale),
                                         .snapshot = snapshot },
                   plan->fields);
    plan->data_utc_ns = snapshot->taken_utc_ns;
    plan->content = content_hash(plan);
    plan->shape = content_hash_shape(plan);
    plan->field_ns += clock_mono_ns() - begin_ns;
}
