/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes the plant file and the tag list of a plant with many equal assets, then prepares and loads the plant. */
#include "tests/support/crowd.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "base/text/text.h"
#include "preprocess/pipeline/prepare.h"
#include "scene/scene_create.h"
#include "tests/support/owned.h"
#include "tests/support/synthetic.h"
#include "value/quality.h"

static const double GAP = 1.01; /* distance between the centres of neighbours, in multiples of their size */
/* width divided by height of the ground area, chosen to fill a wide picture when seen obliquely from above */
static const double ASPECT = 1.0;

struct places { /* positions of the sensors, in the asset's frame */
    double (*at_m)[3];
    int count;
    double size_m[3], middle_m[3]; /* size and centre of the model */
};

/* --- the plant's files -------------------------------------------------------------------------------------------------------- */

/* Returns into how many columns to arrange the assets, so that their ground has about the proportions ASPECT and few places
   stay empty. */
static int columns_of(int instances, const struct places *places)
{
    double wanted = sqrt(instances * ASPECT * places->size_m[1] / places->size_m[0]), least = INFINITY;
    int best = 1;
    for (int columns = 1; columns <= instances; columns++) {
        int rows = (instances + columns - 1) / columns;
        double cost = (double)(rows * columns - instances) / instances + 0.3 * fabs(log(columns / wanted));
        if (cost < least) {
            least = cost;
            best = columns;
        }
    }
    return best;
}

static void add_instance(struct text *yaml, const struct crowd_params *params, const struct places *places, int index)
{
    int columns = columns_of(params->instances, places);
    double x = index % columns * GAP * places->size_m[0] - places->middle_m[0];
    double y = index / columns * GAP * places->size_m[1] - places->middle_m[1];
    text_add(yaml, "  - { id: A%d, model: \"%s\", ", index, params->model);
    if (params->nodes)
        text_add(yaml, "nodes: \"%s\", ", params->nodes);
    text_add(yaml, "up: %s, sensor_frame: asset, placement: { translate: [%.4f, %.4f, 0] } }\n", params->up, x, y);
}

static bool write_files(const struct crowd_params *params, const struct places *places)
{
    struct text yaml = { 0 }, tags = { 0 };
    char *yaml_path = test_printf("%s/plant.yaml", params->folder), *tags_path = test_printf("%s/tags.csv", params->folder);
    text_add(&yaml,
             "plant: { name: Crowd, time_zone: UTC }\n"
             "groups:\n  - { id: t, unit: K, min: 0, max: 100%s%s }\n"
             "tags: tags.csv\nassets:\n",
             params->keys ? ", " : "", params->keys ? params->keys : "");
    text_add(&tags, "Tag Name,Group,Asset,X,Y,Z\n");
    for (int i = 0; i < params->instances; i++) {
        add_instance(&yaml, params, places, i);
        for (int s = 0; s < places->count; s++)
            text_add(&tags, "T%d-%d,t,A%d,%.4f,%.4f,%.4f\n", i, s, i, places->at_m[s][0], places->at_m[s][1], places->at_m[s][2]);
    }
    bool good = (mkdir(params->folder, 0777) == 0 || errno == EEXIST) && atomic_file_put(yaml_path, yaml.at, yaml.length) == 0 &&
                atomic_file_put(tags_path, tags.at, tags.length) == 0;
    text_finish(&yaml);
    text_finish(&tags);
    return good;
}

static bool prepare(struct sensor_crowd *crowd, struct log *log, struct workers *workers, const char *folder)
{
    struct diag diag = { 0 };
    struct prepare prepare;
    char *path = test_printf("%s/plant.yaml", folder);
    crowd->plant = plant_load(path, &diag);
    bool good = crowd->plant != NULL;
    if (good) {
        char *prepared = plant_prepared_folder(crowd->plant);
        good = prepare_run(&prepare, log, workers, crowd->plant, &(struct prepare_params){ .folder = prepared }, &diag);
        prepare_finish(&prepare);
        if (good)
            crowd->scene = scene_create(log, crowd->plant, prepared);
        mem_free(prepared);
    }
    if (!good)
        diag_print(&diag, stderr);
    diag_finish(&diag);
    return good && crowd->scene;
}

/* --- positions of the sensors ------------------------------------------------------------------------------------------------- */

/* Puts each sensor at the vertex farthest from the earlier ones. */
static void spread(struct places *places, const struct asset_view *view)
{
    uint32_t vertices = view->header->vertex_count, next = 0;
    float *nearest = mem_array(vertices, sizeof(*nearest));
    for (uint32_t v = 0; v < vertices; v++)
        nearest[v] = FLT_MAX;
    for (int s = 0; s < places->count; s++) {
        const float *here = view->positions_m[next];
        for (int c = 0; c < 3; c++)
            places->at_m[s][c] = view->header->origin_m[c] + (double)here[c];
        float most = -1;
        for (uint32_t v = 0; v < vertices; v++) {
            const float *at = view->positions_m[v];
            float x = at[0] - here[0], y = at[1] - here[1], z = at[2] - here[2], square = x * x + y * y + z * z;
            nearest[v] = fminf(nearest[v], square);
            if (nearest[v] > most) {
                most = nearest[v];
                next = v;
            }
        }
    }
    mem_free(nearest);
}

/* Chooses sensor positions on the model, prepared once without sensors. */
static bool find_places(struct places *places, struct log *log, struct workers *workers, const struct crowd_params *params)
{
    struct sensor_crowd bare = { 0 };
    char *folder = test_printf("%s-bare", params->folder);
    struct crowd_params one = { .folder = folder, .model = params->model, .nodes = params->nodes, .up = params->up, .instances = 1 };
    struct places none = { .size_m = { 1, 1, 1 } };
    *places = (struct places){ .count = params->sensors, .at_m = mem_array((size_t)params->sensors, sizeof(*places->at_m)) };
    bool good = write_files(&one, &none) && prepare(&bare, log, workers, folder);
    if (good) {
        const struct asset_view *view = &bare.scene->assets[0].file->view;
        for (int c = 0; c < 3; c++) {
            double low = view->header->bounds_min_m[c], high = view->header->bounds_max_m[c];
            places->size_m[c] = high - low;
            places->middle_m[c] = view->header->origin_m[c] + 0.5 * (low + high);
        }
        spread(places, view);
    }
    crowd_finish(&bare);
    return good;
}

/* --- everything --------------------------------------------------------------------------------------------------------------- */

bool crowd_init(struct sensor_crowd *crowd, struct log *log, struct workers *workers, const struct crowd_params *params)
{
    struct places places;
    *crowd = (struct sensor_crowd){ .random = 1 };
    bool good = find_places(&places, log, workers, params) && write_files(params, &places) && prepare(crowd, log, workers, params->folder);
    mem_free(places.at_m);
    if (!good)
        return false;
    crowd->snapshot = snapshot_create(crowd->plant->tag_count);
    crowd_change(crowd, 0);
    return true;
}

void crowd_finish(struct sensor_crowd *crowd)
{
    snapshot_destroy(&crowd->snapshot);
    scene_destroy(&crowd->scene);
    plant_destroy(&crowd->plant);
}

void crowd_change(struct sensor_crowd *crowd, int64_t mono_ns)
{
    crowd->snapshot->taken_mono_ns = mono_ns;
    for (size_t i = 0; i < crowd->plant->tag_count; i++) {
        struct reading *reading = &crowd->snapshot->readings[i];
        *reading = (struct reading){ .value = 100 * synthetic_random_unit(&crowd->random),
                                     .quality = QUALITY_GOOD,
                                     .changes = reading->changes + 1 };
    }
}
