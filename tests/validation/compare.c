/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares the field of a plant that has one asset with a solution on its surface.
   usage: compare numbers PLANT.yaml SOLUTION VALUES.csv   prints one JSON line per interpolation and distance
          compare pictures PLANT.yaml SOLUTION <LIST       each line of LIST: field, solution or error; a file to write; the
                                                           arguments of `plantcast snapshot`; separated by tabs
   parts.py: write_solution() writes SOLUTION. Errors are |field - solution| at the asset's finest vertices, weighted by the surrounding
   area; the solution is taken at the nearest point of its skin. */
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "clients/cli/picture/offline_renderer.h"
#include "clients/cli/readings/values.h"
#include "message/names.h"
#include "plant/influence.h"
#include "scene/scene_create.h"
#include "surface/mesh/bvh.h"
#include "tests/support/whole_field.h"

enum { WORDS = 64, LINE_BYTES = 4096 };

struct solution {
    struct trimesh skin;
    double *values; /* simulated temperature (or other quantity) at each vertex of the skin, the simulation's surface mesh */
    bool *outside;  /* by triangle of the skin: whether it belongs to the outside of the body */
};

struct heat_truth { /* the solution at the asset file's vertices, and the area that each vertex stands for, in all and on the outside */
    double *values, *area_m2, *outside_m2;
    size_t count;
};

struct error {
    double error, area_m2;
};

static bool read_solution(const char *path, struct solution *solution)
{
    struct trimesh *skin = &solution->skin;
    FILE *file = fopen(path, "r");
    if (!file || fscanf(file, "%zu %zu", &skin->point_count, &skin->tri_count) != 2)
        return false;
    skin->points = mem_try_array(skin->point_count, sizeof(*skin->points));
    skin->tris = mem_try_array(skin->tri_count, sizeof(*skin->tris));
    solution->values = mem_try_array(skin->point_count, sizeof(double));
    solution->outside = mem_try_array(skin->tri_count, sizeof(bool));
    bool good = skin->points && skin->tris && solution->values && solution->outside;
    for (size_t i = 0; good && i < skin->point_count; i++) {
        double *p = skin->points[i];
        good = fscanf(file, "%lf %lf %lf %lf", &p[0], &p[1], &p[2], &solution->values[i]) == 4;
    }
    for (size_t i = 0; good && i < skin->tri_count; i++) {
        uint32_t *tri = skin->tris[i], outside;
        good = fscanf(file, "%u %u %u %u", &tri[0], &tri[1], &tri[2], &outside) == 4;
        for (int k = 0; good && k < 3; k++)
            good = tri[k] < skin->point_count;
        solution->outside[i] = good && outside;
    }
    fclose(file);
    return good;
}

static void finish_solution(struct solution *solution)
{
    mem_free(solution->skin.points);
    mem_free(solution->skin.tris);
    mem_free(solution->values);
    mem_free(solution->outside);
}

static double triangle_m2(const float a[3], const float b[3], const float c[3])
{
    double n[3];
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        n[i] = (double)(b[j] - a[j]) * (double)(c[k] - a[k]) - (double)(b[k] - a[k]) * (double)(c[j] - a[j]);
    }
    return sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / 2;
}

/* Takes the solution for each vertex of the asset from the nearest point of the skin. An asset's triangle counts as outside if
   the skin's triangle nearest to its centre does. */
static void find_truth(const struct solution *solution, const struct asset_view *view, struct heat_truth *truth)
{
    struct bvh *bvh = bvh_create(&solution->skin);
    struct bvh_place place;
    const double *origin_m = view->header->origin_m;
    truth->count = view->header->vertex_count;
    truth->values = mem_try_array(truth->count, sizeof(double));
    truth->area_m2 = mem_try_array(truth->count, sizeof(double));
    truth->outside_m2 = mem_try_array(truth->count, sizeof(double));
    for (size_t v = 0; v < truth->count; v++) {
        const float *p = view->positions_m[v];
        bvh_nearest(bvh, (double[3]){ (double)p[0] + origin_m[0], (double)p[1] + origin_m[1], (double)p[2] + origin_m[2] }, INFINITY, NULL,
                    NULL, &place);
        for (int k = 0; k < 3; k++)
            truth->values[v] += place.weights[k] * solution->values[solution->skin.tris[place.tri][k]];
    }
    const struct asset_level *finest = &view->levels[0];
    for (uint32_t i = finest->first_primitive; i < finest->first_primitive + finest->primitive_count; i++) {
        const uint32_t *at = view->indices + view->primitives[i].first_index, *end = at + view->primitives[i].index_count;
        for (; at < end; at += 3) {
            const float *a = view->positions_m[at[0]], *b = view->positions_m[at[1]], *c = view->positions_m[at[2]];
            double middle[3], third_m2 = triangle_m2(a, b, c) / 3;
            for (int k = 0; k < 3; k++)
                middle[k] = ((double)a[k] + (double)b[k] + (double)c[k]) / 3 + origin_m[k];
            bvh_nearest(bvh, middle, INFINITY, NULL, NULL, &place);
            for (int k = 0; k < 3; k++) {
                truth->area_m2[at[k]] += third_m2;
                truth->outside_m2[at[k]] += solution->outside[place.tri] ? third_m2 : 0;
            }
        }
    }
    bvh_destroy(&bvh);
}

static void finish_truth(struct heat_truth *truth)
{
    mem_free(truth->values);
    mem_free(truth->area_m2);
    mem_free(truth->outside_m2);
}

static int by_error(const void *a, const void *b)
{
    double x = ((const struct error *)a)->error, y = ((const struct error *)b)->error;
    return (x > y) - (x < y);
}

/* Prints the mean, the 95th percentile and the largest error, and the share of the area where the field is unknown. */
static void print_errors(const char *where, const struct scalars *scalars, const struct heat_truth *truth, const double *area_m2)
{
    struct error *errors = mem_try_array(truth->count, sizeof(*errors));
    double known_m2 = 0, all_m2 = 0, sum = 0, within_m2 = 0, p95 = 0;
    size_t count = 0;
    for (size_t v = 0; v < truth->count; v++) {
        all_m2 += area_m2[v];
        if (area_m2[v] > 0 && !scalars->at[v].no_data)
            errors[count++] = (struct error){ fabs((double)scalars->at[v].value - truth->values[v]), area_m2[v] };
    }
    qsort(errors, count, sizeof(*errors), by_error);
    for (size_t i = 0; i < count; i++) {
        known_m2 += errors[i].area_m2;
        sum += errors[i].area_m2 * errors[i].error;
    }
    for (size_t i = 0; i < count && within_m2 < 0.95 * known_m2; i++) {
        within_m2 += errors[i].area_m2;
        p95 = errors[i].error;
    }
    printf(", \"%s\": {\"mean\": %.3f, \"p95\": %.3f, \"worst\": %.3f, \"unknown\": %.4f}", where, known_m2 > 0 ? sum / known_m2 : 0, p95,
           count > 0 ? errors[count - 1].error : 0, all_m2 > 0 ? 1 - known_m2 / all_m2 : 0);
    mem_free(errors);
}

static bool print_numbers(char **words, const struct solution *solution)
{
    struct log *log = log_create(LOG_ERROR);
    struct plant *plant = plant_load_or_print(words[0]);
    char *prepared = plant ? plant_prepared_folder(plant) : NULL;
    struct scene *scene = plant ? scene_create(log, plant, prepared) : NULL;
    struct workers *workers = workers_create(0);
    struct field *field = scene ? field_create(workers, scene) : NULL;
    struct snapshot *snapshot = plant ? snapshot_create(plant->tag_count) : NULL;
    struct diag diag = { 0 };
    bool good = field && values_read(plant, words[2], snapshot, &diag);
    diag_print(&diag, stderr);
    if (good) {
        struct heat_truth truth = { 0 };
        struct field_params params;
        find_truth(solution, &scene->assets[0].file->view, &truth);
        for (const struct name *name = names_interpolation; name->text; name++) {
            bool solved = interpolation_is_prepared((enum interpolation)name->value);
            if (solved && !plant_prepares(&plant->groups[0], (enum interpolation)name->value))
                continue;
            for (enum distance_mode mode = 0; mode < (solved ? 1 : DISTANCES); mode++) {
                if (mode == DISTANCE_HEAT && !plant->groups[0].heat)
                    continue;
                field_params_default(plant, 0, &params);
                params.interpolation = (enum interpolation)name->value;
                params.distance = mode;
                const struct scalars *scalars = field_scalars(field, 0, &params, snapshot);
                good = good && scalars;
                if (!scalars)
                    continue;
                printf("{\"interpolation\": \"%s\", \"distance\": \"%s\"", name->text, solved ? "" : name_of(names_distance, (int)mode));
                print_errors("outside", scalars, &truth, truth.outside_m2);
                print_errors("whole", scalars, &truth, truth.area_m2);
                printf("}\n");
            }
        }
        finish_truth(&truth);
    }
    diag_finish(&diag);
    snapshot_destroy(&snapshot);
    field_destroy(&field);
    workers_destroy(&workers);
    scene_destroy(&scene);
    mem_free(prepared);
    plant_destroy(&plant);
    log_destroy(&log);
    return good;
}

/* --- pictures: the linker replaces the field's functions with these (Makefile) ------------------------------------------------- */

enum paint { PAINT_FIELD, PAINT_SOLUTION, PAINT_ERROR };
static struct {
    enum paint paint;
    struct heat_truth truth;
    struct scalar *at;
    struct scalars scalars;
} painted;

const struct scalars *__real_field_scalars_of(struct field *field, int asset, const struct field_params *params,
                                              const struct snapshot *snapshot, size_t count);
const struct scalars *__wrap_field_scalars_of(struct field *field, int asset, const struct field_params *params,
                                              const struct snapshot *snapshot, size_t count);
const struct scalars *__wrap_field_scalars_of(struct field *field, int asset, const struct field_params *params,
                                              const struct snapshot *snapshot, size_t count)
{
    const struct scalars *own = __real_field_scalars_of(field, asset, params, snapshot, count);
    if (painted.paint == PAINT_FIELD || !own || own->count != painted.truth.count)
        return own;
    painted.scalars = *own;
    painted.scalars.version += (uint64_t)painted.paint << 40;
    painted.scalars.flags_version += (uint64_t)painted.paint << 40;
    painted.scalars.at = painted.at;
    for (size_t v = 0; v < own->count; v++) {
        double value = painted.truth.values[v];
        painted.at[v] = painted.paint == PAINT_ERROR ? own->at[v] : (struct scalar){ 0 };
        painted.at[v].value = (float)(painted.paint == PAINT_ERROR ? fabs((double)own->at[v].value - value) : value);
    }
    return &painted.scalars;
}

static int split(char *line, char **words)
{
    int count = 0;
    line[strcspn(line, "\n")] = 0;
    for (char *word = strtok(line, "\t"); word && count < WORDS; word = strtok(NULL, "\t"))
        words[count++] = word;
    return count;
}

static bool draw(struct offline_renderer *offline, char *plant, const struct solution *solution, char *line)
{
    char *words[WORDS + 4] = { "compare", plant, "-o" };
    struct snapshot_options options;
    struct view view;
    int count = 2 + split(line, words + 2);
    const char *paint = words[2];
    words[2] = "-o";
    optind = 0; /* makes getopt start again at the first word */
    bool first = !offline->gl, good = count > 3 && snapshot_parse(count, words, false, &options) < 0;
    if (!good)
        return false;
    good = (first ? offline_renderer_open(offline, &options, &view) : offline_renderer_reopen(offline, &options, &view)) == 0;
    if (good && first) {
        find_truth(solution, &offline->scene->assets[0].file->view, &painted.truth);
        painted.at = mem_try_array(painted.truth.count, sizeof(*painted.at));
    }
    painted.paint = strcmp(paint, "solution") == 0 ? PAINT_SOLUTION : strcmp(paint, "error") == 0 ? PAINT_ERROR : PAINT_FIELD;
    good = good && (!first || offline_renderer_open_gl(offline, &options));
    struct frame *frame = good ? offline_renderer_draw(offline, &options, &view) : NULL;
    good = frame && offline_renderer_save(offline, frame, options.out);
    frame_unref(&frame);
    snapshot_options_finish(&options);
    return good;
}

static bool draw_pictures(char *plant, const struct solution *solution)
{
    struct offline_renderer offline = { 0 };
    char line[LINE_BYTES];
    bool good = true;
    while (good && fgets(line, sizeof(line), stdin))
        good = draw(&offline, plant, solution, line);
    offline_renderer_close(&offline);
    finish_truth(&painted.truth);
    mem_free(painted.at);
    return good;
}

int main(int argc, char **argv)
{
    struct solution solution = { 0 };
    bool numbers = argc == 5 && strcmp(argv[1], "numbers") == 0, pictures = argc == 4 && strcmp(argv[1], "pictures") == 0;
    bool good = (numbers || pictures) && read_solution(argv[3], &solution);
    if (!good)
        fprintf(stderr, "compare: %s\n", numbers || pictures ? "the solution cannot be read" : "see the head of compare.c");
    else
        good = numbers ? print_numbers(argv + 2, &solution) : draw_pictures(argv[2], &solution);
    finish_solution(&solution);
    return !good;
}
