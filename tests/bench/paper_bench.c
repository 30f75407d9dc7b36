/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The two experiments of the paper at 1920x1080: many instances with 5 sensors each, and many sensors on one instance. All
   readings change ten times per second while the camera swings. Each row is one JSON line, followed by a row for brute force
   (all triangles of the finest level, and the paper's sum over all sensors per fragment). With straight-line distances, only
   rows with MANY_INSTANCES, and with few and many sensors, are measured, without brute force.
   usage: paper_bench [cpu|gpu [INSTANCES SENSORS [SUFFIX]]]
   runs only these rows, 0: none; SUFFIX: only rows with this ending, such as _euclidean; gpu: only on an EGL device that is hardware */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/math/search.h"
#include "base/mem.h"
#include "plant/colormaps.h"
#include "render/renderer.h"
#include "tests/support/crowd.h"
#include "tests/support/measure.h"
#include "tests/support/planned.h"

#define DEMO_MODEL "build/demo/plant.glb"
#define PLANT_MODEL "../shared/data/models/plm_plant_5parts.glb"
#define FOLDER "build/bench"
enum { WIDTH_PX = 1920, HEIGHT_PX = 1080, PROBE_WIDTH_PX = 192, PROBE_HEIGHT_PX = 108 };
/* the work of a frame with MANY_SENSORS may be at most 1.05 times that of a frame with FEW_SENSORS */
enum { FEW_SENSORS = 5, MANY_SENSORS = 512, MANY_INSTANCES = 100 };
enum { IN_FLIGHT = 3, FLOW_FRAMES = 960 };    /* for the throughput measurement: frames submitted to the GPU ahead, and frames per run */
enum { CAMERAS = 48, MOST_FRAMES = 96, LEAST_FRAMES = 2, HULL_POINTS = 96 };
/* interval between changes of all readings; maximum time spent on the measurements of one printed row */
static const int64_t CHANGE_NS = 100 * NS_PER_MS, LONGEST_NS = 3 * NS_PER_S;
/* milliseconds; if a brute-force frame is expected to take longer, only one is drawn for its row */
static const double LONGEST_BRUTE_MS = 20e3;
static const double SWING_RAD = 6 * M_PI / 180, FOV_DEG = 15, WANTED_COVERAGE = 0.6;

struct paper_model {
    const char *path, *nodes, *up, *suffix; /* ending of the names of the printed rows, such as "_5parts" */
    const char *keys;                       /* keys of the group in the plant file: interpolation and distance; NULL: defaults */
};
static const struct paper_model models[] = {
    { DEMO_MODEL, "E-101", "y", "", NULL },
    { PLANT_MODEL, NULL, "y", "_5parts", NULL },
    { DEMO_MODEL, "E-101", "y", "_euclidean", "distance: euclidean" },
    { PLANT_MODEL, NULL, "y", "_5parts_euclidean", "distance: euclidean" },
    { DEMO_MODEL, "E-101", "y", "_paper_euclidean", "interpolation: paper, distance: euclidean" },
};

struct paper_bench {
    struct log *log;
    struct workers *workers;
    struct gl *gl;
    struct sensor_crowd crowd;
    struct field *field;
    struct renderer *renderer;
    double hull_m[HULL_POINTS][3];
    struct camera cameras[CAMERAS];
    /* smallest share, over all cameras, of a picture's pixels that show a field (the interpolated readings on an asset's
       surface) */
    double coverage;
    /* time and number of sensors of the previous brute-force row, from which the time of the next one is estimated;
       brute_sensors 0: no such row */
    double brute_ms;
    int brute_sensors;
    double few_ms; /* processor time in ms of a frame with FEW_SENSORS, the reference of compare_sensors(); 0: not measured */
};

struct timing_series { /* measured times of one row */
    double time_ms[MOST_FRAMES], work_ms[MOST_FRAMES];
    int frames, triangles, changes;
    double seconds;
};

/* --- cameras with the whole scene in view --------------------------------------------------------------------------------- */

/* Finds the outermost point of the model in each of HULL_POINTS directions, in the plant's axes but without the offset of an
   instance. */
static void find_hull(struct paper_bench *bench)
{
    const struct scene_asset *asset = &bench->crowd.scene->assets[0];
    const struct asset_view *file = &asset->file->view;
    for (int i = 0; i < HULL_POINTS; i++) {
        double height = 1 - (2 * i + 1.0) / HULL_POINTS, angle = i * 2.399963229728653, flat = sqrt(1 - height * height), most = -INFINITY;
        double towards[3] = { flat * cos(angle), flat * sin(angle), height };
        for (uint32_t v = 0; v < file->header->vertex_count; v++) {
            const float *p = file->positions_m[v];
            double far = p[0] * towards[0] + p[1] * towards[1] + p[2] * towards[2];
            if (far <= most)
                continue;
            most = far;
            for (int c = 0; c < 3; c++)
                bench->hull_m[i][c] = (double)p[c];
        }
    }
}

/* Computes how far all instances extend in the picture of a camera at eye_m, as tangents of the angles from its axis. Instances
   are translated copies without rotation, so the hull points plus the offsets suffice. */
static void find_extremes(const struct paper_bench *bench, const double eye_m[3], double axes[3][3], double low[2], double high[2])
{
    low[0] = low[1] = INFINITY;
    high[0] = high[1] = -INFINITY;
    for (size_t i = 0; i < bench->crowd.scene->asset_count; i++)
        for (int h = 0; h < HULL_POINTS; h++) {
            double at[3] = { 0, 0, 0 };
            for (int c = 0; c < 3; c++)
                for (int axis = 0; axis < 3; axis++)
                    at[axis] += (bench->crowd.scene->assets[i].placement[12 + c] + bench->hull_m[h][c] - eye_m[c]) * axes[axis][c];
            for (int axis = 0; axis < 2; axis++) {
                low[axis] = fmin(low[axis], at[axis] / at[2]);
                high[axis] = fmax(high[axis], at[axis] / at[2]);
            }
        }
}

/* Places the camera in the given direction (azimuth, elevation) from the instances, as close as possible with all of them still
   in the picture. */
static void fit(const struct paper_bench *bench, double azimuth, double elevation, struct camera *camera)
{
    const struct scene *scene = bench->crowd.scene;
    double axes[3][3] = { { -sin(azimuth), cos(azimuth), 0 }, /* unit vectors to the camera's right, up and ahead */
                          { -cos(azimuth) * sin(elevation), -sin(azimuth) * sin(elevation), cos(elevation) },
                          { -cos(azimuth) * cos(elevation), -sin(azimuth) * cos(elevation), -sin(elevation) } };
    double half = tan(FOV_DEG * M_PI / 360), distance_m = 0;
    *camera = (struct camera){ .up = { 0, 0, 1 }, .fov_deg = FOV_DEG };
    for (int c = 0; c < 3; c++) {
        camera->target_m[c] = 0.5 * (scene->bounds_min_m[c] + scene->bounds_max_m[c]);
        distance_m = fmax(distance_m, 4 * (scene->bounds_max_m[c] - scene->bounds_min_m[c]));
    }
    for (int round = 0; round < 30; round++) {
        double low[2], high[2];
        for (int c = 0; c < 3; c++)
            camera->eye_m[c] = camera->target_m[c] - distance_m * axes[2][c];
        find_extremes(bench, camera->eye_m, axes, low, high);
        for (int c = 0; c < 3; c++)
            camera->target_m[c] += 0.5 * distance_m * ((low[0] + high[0]) * axes[0][c] + (low[1] + high[1]) * axes[1][c]);
        distance_m *= 0.5 + 0.5 * fmax((high[0] - low[0]) * HEIGHT_PX / WIDTH_PX, high[1] - low[1]) / (2 * half);
    }
    for (int c = 0; c < 3; c++)
        camera->eye_m[c] = camera->target_m[c] - 1.002 * distance_m * axes[2][c];
}

static void make_view(const struct paper_bench *bench, int width_px, int height_px, struct view *view)
{
    view_default(bench->crowd.scene, width_px, height_px, view);
    view->tier = TIER_PREVIEW;
}

static struct frame *draw(struct paper_bench *bench, const struct view *view)
{
    struct frame *frame = split_view_draw_now(bench->renderer, view, bench->crowd.snapshot);
    if (!frame)
        abort();
    return frame;
}

/* Returns the share of the picture's pixels that show a field: draws the picture with two colour maps and counts the pixels
   that differ. Ground and shadows do not differ and so do not count. */
static double coverage_from(struct paper_bench *bench, const struct camera *camera)
{
    struct view view;
    make_view(bench, PROBE_WIDTH_PX, PROBE_HEIGHT_PX, &view);
    view.camera = *camera;
    struct frame *one = draw(bench, &view);
    view.colormap = colormap_find(NULL, "turbo");
    struct frame *other = draw(bench, &view);
    int covered = 0;
    for (int i = 0; i < PROBE_WIDTH_PX * PROBE_HEIGHT_PX; i++)
        covered += memcmp(one->bgrx + 4 * i, other->bgrx + 4 * i, 3) != 0;
    frame_unref(&one);
    frame_unref(&other);
    return (double)covered / (PROBE_WIDTH_PX * PROBE_HEIGHT_PX);
}

struct view_side {
    double azimuth, elevation, coverage;
};

static void try_side(struct paper_bench *bench, double azimuth, double elevation, struct view_side *best)
{
    struct camera camera;
    fit(bench, azimuth, elevation, &camera);
    double coverage = coverage_from(bench, &camera);
    if (coverage > best->coverage)
        *best = (struct view_side){ azimuth, elevation, coverage };
}

/* Chooses the direction from which the instances fill the picture best, and cameras on a swing around it. No two cameras are
   equal, because the renderer would reuse the frame of a still camera. */
static void choose_cameras(struct paper_bench *bench)
{
    struct view_side best = { 0 };
    find_hull(bench);
    for (int a = 0; a < 18; a++)
        for (int e = 0; e < 4; e++)
            try_side(bench, a * M_PI / 9, (10 + 15 * e) * M_PI / 180, &best);
    double azimuth = best.azimuth, elevation = best.elevation;
    for (int a = -4; a <= 4; a++)
        for (int e = -2; e <= 2; e++)
            try_side(bench, azimuth + a * M_PI / 72, elevation + e * M_PI / 36, &best);
    bench->coverage = 1;
    for (int i = 0; i < CAMERAS; i++) {
        fit(bench, best.azimuth + SWING_RAD * sin(2 * M_PI * (i + 0.25) / CAMERAS), best.elevation, &bench->cameras[i]);
        if (i % 6 == 0)
            bench->coverage = fmin(bench->coverage, coverage_from(bench, &bench->cameras[i]));
    }
}

/* --- rows ------------------------------------------------------------------------------------------------------------------- */

/* Writes the scene for the comparison program (tests/bench/vtk_peer.py), which draws the same. */
static void write_scene(const struct paper_bench *bench, const char *folder)
{
    char *path = mem_printf("%s/scene.json", folder);
    FILE *out = fopen(path, "w");
    const struct scene *scene = bench->crowd.scene;
    mem_free(path);
    if (!out)
        return;
    fprintf(out, "{\"asset\": \"%s\", \"width\": %d, \"height\": %d, \"fov\": %g, \"sensors\": %zu,\n\"places\": [",
            scene->assets[0].file->path, WIDTH_PX, HEIGHT_PX, FOV_DEG, scene->assets[0].sensor_count);
    for (size_t i = 0; i < scene->asset_count; i++) {
        const double *at = &scene->assets[i].placement[12];
        fprintf(out, "%s[%.6f, %.6f, %.6f]", i ? ", " : "", at[0], at[1], at[2]);
    }
    fprintf(out, "],\n\"cameras\": [");
    for (int i = 0; i < CAMERAS; i++) {
        const struct camera *camera = &bench->cameras[i];
        fprintf(out, "%s[%.6f, %.6f, %.6f, %.6f, %.6f, %.6f]", i ? ", " : "", camera->eye_m[0], camera->eye_m[1], camera->eye_m[2],
                camera->target_m[0], camera->target_m[1], camera->target_m[2]);
    }
    fprintf(out, "]}\n");
    fclose(out);
}

static bool bench_init(struct paper_bench *bench, const struct paper_model *model, int instances, int sensors)
{
    char *folder = mem_printf(FOLDER "/crowd%s-%dx%d", model->suffix, instances, sensors), *path = realpath(model->path, NULL);
    struct crowd_params params = { .folder = folder,
                                   .model = path,
                                   .nodes = model->nodes,
                                   .up = model->up,
                                   .keys = model->keys,
                                   .instances = instances,
                                   .sensors = sensors };
    bool good = path && crowd_init(&bench->crowd, bench->log, bench->workers, &params);
    if (good) {
        bench->field = field_create(bench->workers, bench->crowd.scene);
        bench->renderer = renderer_create(bench->log, bench->gl, bench->crowd.scene, bench->field);
        good = bench->renderer != NULL;
    }
    if (good) {
        choose_cameras(bench);
        write_scene(bench, folder);
    }
    mem_free(folder);
    free(path);
    return good;
}

static void bench_finish(struct paper_bench *bench)
{
    renderer_destroy(&bench->renderer);
    field_destroy(&bench->field);
    crowd_finish(&bench->crowd);
}

static void draw_one(struct paper_bench *bench, struct timing_series *series, struct view *view, int number)
{
    double start_ms = measure_ms(CLOCK_MONOTONIC), worked_ms = measure_ms(CLOCK_PROCESS_CPUTIME_ID);
    view->camera = bench->cameras[(number + CAMERAS) % CAMERAS];
    struct frame *frame = draw(bench, view);
    if (number >= 0) {
        series->time_ms[number] = measure_ms(CLOCK_MONOTONIC) - start_ms;
        series->work_ms[number] = measure_ms(CLOCK_PROCESS_CPUTIME_ID) - worked_ms;
        series->triangles = frame->triangles;
        series->frames++;
    }
    frame_unref(&frame);
}

static void run_series(struct paper_bench *bench, struct timing_series *series)
{
    struct view view;
    int64_t began_ns = 0, changed_ns = clock_mono_ns();
    *series = (struct timing_series){ 0 };
    make_view(bench, WIDTH_PX, HEIGHT_PX, &view);
    for (int i = -1; i < MOST_FRAMES; i++) {
        int64_t now_ns = clock_mono_ns();
        if (i == 0)
            began_ns = now_ns;
        if (i >= LEAST_FRAMES && now_ns - began_ns > LONGEST_NS)
            break;
        if (now_ns - changed_ns >= CHANGE_NS) {
            changed_ns = now_ns;
            crowd_change(&bench->crowd, now_ns);
            series->changes += i >= 0;
        }
        draw_one(bench, series, &view, i);
    }
    series->seconds = (double)(clock_mono_ns() - began_ns) / 1e9;
}

/* Draws and measures a single frame, however long it takes. Before that, draws a small frame so that all data is uploaded to
   the GPU. */
static void run_one(struct paper_bench *bench, struct timing_series *series)
{
    struct view view;
    *series = (struct timing_series){ 0 };
    make_view(bench, PROBE_WIDTH_PX, PROBE_HEIGHT_PX, &view);
    draw_one(bench, series, &view, -1);
    make_view(bench, WIDTH_PX, HEIGHT_PX, &view);
    draw_one(bench, series, &view, 0);
    series->seconds = series->time_ms[0] / 1e3;
}

/* Measures throughput: submits IN_FLIGHT frames to the GPU before the oldest of them is finished. */
static void run_flow(struct paper_bench *bench, struct timing_series *series)
{
    struct view view;
    struct render_job *flying[IN_FLIGHT] = { NULL };
    int64_t began_ns = 0, changed_ns = clock_mono_ns();
    double worked_ms = 0;
    *series = (struct timing_series){ 0 };
    make_view(bench, WIDTH_PX, HEIGHT_PX, &view);
    for (int i = -IN_FLIGHT; i < FLOW_FRAMES; i++) {
        int64_t now_ns = clock_mono_ns();
        struct render_job **job = &flying[(i + IN_FLIGHT) % IN_FLIGHT];
        if (i == 0) {
            began_ns = now_ns;
            worked_ms = measure_ms(CLOCK_PROCESS_CPUTIME_ID);
        }
        if (now_ns - changed_ns >= CHANGE_NS) {
            changed_ns = now_ns;
            crowd_change(&bench->crowd, now_ns);
            series->changes += i >= 0;
        }
        if (*job) {
            struct frame *frame = renderer_end(bench->renderer, job);
            series->triangles = frame->triangles;
            frame_unref(&frame);
        }
        view.camera = bench->cameras[(i + CAMERAS) % CAMERAS];
        *job = planned_submit(bench->renderer, &view, bench->crowd.snapshot);
    }
    series->seconds = (double)(clock_mono_ns() - began_ns) / 1e9;
    for (int i = 0; i < IN_FLIGHT; i++)
        renderer_abandon(bench->renderer, &flying[i]);
    series->frames = 1;
    series->time_ms[0] = series->seconds * 1e3 / FLOW_FRAMES;
    series->work_ms[0] = (measure_ms(CLOCK_PROCESS_CPUTIME_ID) - worked_ms) / FLOW_FRAMES;
}

static void print_row(const struct paper_bench *bench, const char *name, struct timing_series *series, double goal_ms)
{
    int middle = series->frames / 2, late = series->frames * 95 / 100;
    double columns = series->changes * (double)bench->crowd.plant->tag_count / series->seconds;
    qsort(series->time_ms, (size_t)series->frames, sizeof(double), compare_doubles);
    qsort(series->work_ms, (size_t)series->frames, sizeof(double), compare_doubles);
    printf("{\"name\": \"%s\", \"value\": %.2f, \"p95\": %.2f, \"unit\": \"ms\", ", name, series->time_ms[middle], series->time_ms[late]);
    if (goal_ms > 0)
        printf("\"goal\": [\"<=\", %g], ", goal_ms);
    if (bench->coverage < WANTED_COVERAGE)
        printf("\"note\": \"covers less than 60 %% somewhere\", ");
    printf("\"cpu\": %.2f, \"tier\": \"moving\", \"coverage\": %.2f, \"triangles\": %d, \"columns_per_s\": %.0f, \"frames\": %d}\n",
           series->work_ms[middle], bench->coverage, series->triangles, columns, series->frames);
    fflush(stdout);
}

/* Prints the ratio of a frame's work with MANY_SENSORS to that with FEW_SENSORS; the goal is at most 1.05, since the work
   should not grow with the number of sensors. */
static void compare_sensors(struct paper_bench *bench, const struct paper_model *model, int sensors, const struct timing_series *series)
{
    double here_ms = series->work_ms[series->frames / 2];
    if (sensors == FEW_SENSORS)
        bench->few_ms = here_ms;
    if (sensors == MANY_SENSORS && bench->few_ms > 0)
        printf("{\"name\": \"render_sensors_%d_over_%d%s\", \"value\": %.2f, \"unit\": \"x\", \"goal\": [\"<=\", 1.05]}\n", MANY_SENSORS,
               FEW_SENSORS, model->suffix, here_ms / bench->few_ms);
}

static void print_missing(const char *name, const char *why)
{
    printf("{\"name\": \"%s\", \"value\": null, \"p95\": null, \"unit\": \"ms\", \"why\": \"%s\"}\n", name, why);
    fflush(stdout);
}

/* Measures the brute-force method, whose time grows with the number of sensors. Draws a single frame if the previous row
   predicts more than LONGEST_BRUTE_MS. */
static void measure_brute(struct paper_bench *bench, const char *name, int sensors, struct timing_series *series)
{
    bool slow = bench->brute_sensors > 0 && bench->brute_ms * sensors / bench->brute_sensors > LONGEST_BRUTE_MS;
    renderer_set_per_fragment(bench->renderer, true);
    if (slow)
        run_one(bench, series);
    else
        run_series(bench, series);
    print_row(bench, name, series, 0);
    bench->brute_ms = series->time_ms[series->frames / 2];
    bench->brute_sensors = sensors;
}

static void measure(struct paper_bench *bench, const struct paper_model *model, const char *kind, int instances, int sensors,
                    double goal_ms)
{
    struct timing_series *series = mem_new(sizeof(*series));
    int count = sensors == 5 && !strcmp(kind, "instances") ? instances : sensors;
    char *name = mem_printf("render_%s_%d%s_ms", kind, count, model->suffix);
    char *flow_name = mem_printf("flow_%s_%d%s_ms", kind, count, model->suffix);
    char *brute_name = mem_printf("brute_%s_%d%s_ms", kind, count, model->suffix);
    if (access(model->path, R_OK) != 0) {
        print_missing(name, "its model is not there");
    } else if (!bench_init(bench, model, instances, sensors)) {
        print_missing(name, "its plant could not be prepared or drawn; the log says why");
    } else {
        run_series(bench, series);
        print_row(bench, name, series, goal_ms);
        if (strcmp(kind, "sensors") == 0)
            compare_sensors(bench, model, sensors, series);
        if (!bench->gl->software) {
            run_flow(bench, series);
            print_row(bench, flow_name, series, goal_ms);
        }
        if (!model->keys)
            measure_brute(bench, brute_name, sensors, series);
    }
    bench_finish(bench);
    mem_free(name);
    mem_free(brute_name);
    mem_free(flow_name);
    mem_free(series);
}

struct goal { /* goals for the row with `count` instances or sensors; 0: no goal */
    int count;
    /* goals in milliseconds per frame: cpu_ms on two cores for each of the first two models; gpu_ms a tenth of the paper's
       times */
    double cpu_ms[2], gpu_ms;
};
static const struct goal instance_goals[] = {
    { 1, { 7, 7 }, 100.0 / 420 }, { 5, { 0 }, 0 }, { 25, { 0 }, 0 }, { 100, { 14, 22 }, 100.0 / 140 }, { 400, { 25, 45 }, 0 }
};
static const struct goal sensor_goals[] = { { .count = 5 },    { .count = 10 },  { .count = 20 },  { .count = 32 },
                                            { .count = 64 },   { .count = 128 }, { .count = 256 }, { .count = 512, .gpu_ms = 100.0 / 200 },
                                            { .count = 1024 }, { .count = 4096 } };
enum { INSTANCE_GOALS = sizeof(instance_goals) / sizeof(instance_goals[0]), SENSOR_GOALS = sizeof(sensor_goals) / sizeof(sensor_goals[0]) };

/* Measures the rows of one model. instances, sensors: measure only the row with that number; -1: all rows; 0: none. */
static void measure_model(struct paper_bench *bench, const struct paper_model *model, bool gpu, int instances, int sensors)
{
    for (int i = 0; i < INSTANCE_GOALS; i++) {
        const struct goal *goal = &instance_goals[i];
        bench->brute_sensors = 0;
        if (instances < 0 ? !model->keys || goal->count == MANY_INSTANCES : instances == goal->count)
            measure(bench, model, "instances", goal->count, 5, model->keys ? 0 : gpu ? goal->gpu_ms : goal->cpu_ms[model - models]);
    }
    bench->brute_sensors = 0;
    bench->few_ms = 0;
    for (int i = 0; i < SENSOR_GOALS; i++) {
        const int count = sensor_goals[i].count;
        if (sensors < 0 ? !model->keys || count == FEW_SENSORS || count == MANY_SENSORS : sensors == count)
            measure(bench, model, "sensors", 1, count, gpu && !model->keys ? sensor_goals[i].gpu_ms : 0);
    }
}

int main(int argc, char **argv)
{
    struct paper_bench bench = { .log = log_create(LOG_ERROR), .workers = workers_create(0) };
    bool gpu = argc > 1 && !strcmp(argv[1], "gpu");
    int instances = argc > 3 ? atoi(argv[2]) : -1, sensors = argc > 3 ? atoi(argv[3]) : -1;
    mkdir(FOLDER, 0777);
    bench.gl = gl_create(bench.log, gpu ? GL_EGL_DEVICE : GL_AUTO, NULL);
    if (!bench.gl)
        print_missing("render_instances_1_ms", "no OpenGL 4.5 context; the log says why");
    else if (gpu && bench.gl->software)
        print_missing("render_instances_1_ms", "no EGL device is hardware");
    else
        for (size_t m = 0; m < sizeof(models) / sizeof(models[0]); m++)
            if (argc <= 4 || !strcmp(argv[4], models[m].suffix))
                measure_model(&bench, &models[m], gpu, instances, sensors);
    gl_destroy(&bench.gl);
    workers_destroy(&bench.workers);
    log_destroy(&bench.log);
    return 0;
}
