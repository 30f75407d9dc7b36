/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures frames of the demo plant at 1920x1080: elapsed time and processor time on all cores. Prints one JSON line per kind
   of frame. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/math/search.h"
#include "tests/support/demo_scene.h"
#include "tests/support/measure.h"
#include "tests/support/planned.h"
#include "value/quality.h"

enum { MOVING_ROUNDS = 40, STILL_ROUNDS = 8, MOST_ROUNDS = 40 };

/* Prints the median and the 95th percentile of the values (ms). goal: largest median allowed; 0: no goal. */
static void print_row(const char *name, double *values, int count, double goal)
{
    qsort(values, (size_t)count, sizeof(*values), compare_doubles);
    printf("{\"name\": \"%s\", \"value\": %.2f, \"p95\": %.2f, \"unit\": \"ms\"", name, values[count / 2], values[count * 95 / 100]);
    if (goal > 0)
        printf(", \"goal\": [\"<=\", %g]", goal);
    printf("}\n");
    fflush(stdout);
}

static void print_why(const char *why)
{
    printf("{\"name\": \"render_moving_1080p_ms\", \"value\": null, \"p95\": null, \"unit\": \"ms\", \"why\": \"%s\"}\n", why);
}

/* Sets every tag of a group to a different value within the group's range, with quality Good. */
static void fill(struct snapshot *snapshot, const struct plant *plant)
{
    snapshot->taken_mono_ns = clock_mono_ns();
    snapshot->taken_utc_ns = clock_utc_ns();
    for (size_t i = 0; i < plant->tag_count; i++) {
        const struct plant_tag *tag = &plant->tags[i];
        double part = (double)(i * 37 % 100) / 100;
        if (tag->group < 0)
            continue;
        const struct plant_group *group = &plant->groups[tag->group];
        snapshot->readings[i] = (struct reading){ .value = group->min + part * (group->max - group->min), .quality = QUALITY_GOOD };
    }
}

enum dress { PLAIN, LINED, BANDED, LOGARITHMIC, LIMITS, CUT, ORTHOGRAPHIC, GHOSTS, GLOSSY };
enum { GHOST_COUNT = 5 };

static void put_on(const struct demo_scene *bench, enum dress dress, struct view *view)
{
    double range = view->range_max - view->range_min;
    for (int i = 1; dress == LINED && i < 10; i++)
        view->color_scale.lines[view->color_scale.line_count++] = view->range_min + 0.1 * i * range;
    view->ramp_interval = dress == BANDED ? 0.1 * range : 0;
    if (dress == LOGARITHMIC) {
        view->range_min = fmax(view->range_min, 0.01 * view->range_max);
        view->color_scale.log = true;
    }
    if (dress == LIMITS) {
        view->field.show = SHOW_OPERATOR;
        view_default_scale(bench->scene, view);
    }
    if (dress == ORTHOGRAPHIC) {
        double away_m = 0;
        for (int c = 0; c < 3; c++)
            away_m = hypot(away_m, view->camera.eye_m[c] - view->camera.target_m[c]);
        view->camera.height_m = 2 * away_m * tan(view->camera.fov_deg * M_PI / 360);
    }
    for (int i = 0; dress == GHOSTS && i < GHOST_COUNT; i++)
        asset_set_add(&view->visibility.ghosts, i * (int)bench->scene->asset_count / GHOST_COUNT);
    view->look = dress == GLOSSY ? LOOK_GLOSSY : view->look;
    if (dress == CUT) { /* clips everything above half the plant's height, so that cut bodies get section caps (the filled cut faces) */
        double middle_m = 0.5 * (bench->scene->bounds_min_m[2] + bench->scene->bounds_max_m[2]);
        view->visibility.clip = (struct clip){ .plane_count = 1, .planes = { { 0, 0, -1, middle_m } } };
    }
}

/* Draws a frame. *time_ms receives the elapsed time, *work_ms the processor time. */
static void measure_frame(struct demo_scene *bench, const struct view *view, double *time_ms, double *work_ms)
{
    double began_ms = measure_ms(CLOCK_MONOTONIC), worked_ms = measure_ms(CLOCK_PROCESS_CPUTIME_ID);
    struct frame *frame = split_view_draw_now(bench->renderer, view, bench->snapshot);
    if (!frame)
        abort();
    frame_unref(&frame);
    *time_ms = measure_ms(CLOCK_MONOTONIC) - began_ms;
    *work_ms = measure_ms(CLOCK_PROCESS_CPUTIME_ID) - worked_ms;
}

/* Measures drawing the plant's initial view. The camera moves slightly before each frame, because a frame of a still camera
   would only be recoloured. */
static void measure(struct demo_scene *bench, enum tier tier, enum dress dress, const char *time_name, const char *work_name, int rounds)
{
    struct view view;
    double time_ms[MOST_ROUNDS], work_ms[MOST_ROUNDS];
    view_default(bench->scene, 1920, 1080, &view);
    view.tier = tier;
    put_on(bench, dress, &view);
    for (int i = -2; i < rounds; i++) {
        view.camera.eye_m[0] += 0.001;
        measure_frame(bench, &view, &time_ms[i < 0 ? 0 : i], &work_ms[i < 0 ? 0 : i]);
    }
    print_row(time_name, time_ms, rounds, tier == TIER_REFINED ? 300 : 0);
    print_row(work_name, work_ms, rounds, 0);
}

static void measure_all(struct demo_scene *bench, enum tier tier, int rounds)
{
    static const char *const names[] = { "", "lines_", "bands_", "log_", "operator_", "cut_", "orthographic_", "ghosts_", "glossy_" };
    for (enum dress dress = PLAIN; dress <= GLOSSY; dress++) {
        char time_name[64], work_name[64];
        const char *shown = tier == TIER_PREVIEW ? "moving" : "still";
        snprintf(time_name, sizeof(time_name), "render_%s_%s1080p_ms", shown, names[dress]);
        snprintf(work_name, sizeof(work_name), "render_%s_%s1080p_cpu_ms", shown, names[dress]);
        measure(bench, tier, dress, time_name, work_name, rounds);
    }
}

/* Measures a frame in which the camera stands still and one reading has changed: only colours are computed again. */
static void measure_recolour(struct demo_scene *bench)
{
    struct view view;
    double time_ms[MOVING_ROUNDS], work_ms[MOVING_ROUNDS];
    size_t tag = 0;
    view_default(bench->scene, 1920, 1080, &view);
    view.tier = TIER_PREVIEW;
    while (tag + 1 < bench->plant->tag_count && bench->plant->tags[tag].group != view.field.group)
        tag++;
    const struct plant_group *group = &bench->plant->groups[view.field.group];
    for (int i = -3; i < MOVING_ROUNDS; i++) { /* the first frames (i < 0) fill caches and are not measured; the others only recolour */
        bench->snapshot->readings[tag].value = group->min + (0.3 + 0.01 * (i + 3)) * (group->max - group->min);
        measure_frame(bench, &view, &time_ms[i < 0 ? 0 : i], &work_ms[i < 0 ? 0 : i]);
    }
    print_row("recolour_ms", time_ms, MOVING_ROUNDS, 4);
    print_row("recolour_cpu_ms", work_ms, MOVING_ROUNDS, 0);
}

/* Draws a refined frame in steps of at most 10 ms, between which the renderer may serve other clients. Measures the total work
   and the longest step, which is the longest time that other clients wait. */
static void measure_steps(struct demo_scene *bench)
{
    struct view view;
    double work_ms[STILL_ROUNDS], longest_ms[STILL_ROUNDS] = { 0 }, longest_work_ms[STILL_ROUNDS] = { 0 };
    view_default(bench->scene, 1920, 1080, &view);
    view.tier = TIER_REFINED;
    for (int i = -1; i < STILL_ROUNDS; i++) {
        double worked_ms = measure_ms(CLOCK_PROCESS_CPUTIME_ID), longest = 0, longest_work = 0;
        struct render_job *job = planned_begin(bench->renderer, &view, bench->snapshot);
        if (!job)
            abort();
        for (bool done = false; !done;) {
            double began_ms = measure_ms(CLOCK_MONOTONIC), work_began_ms = measure_ms(CLOCK_PROCESS_CPUTIME_ID);
            done = renderer_step(bench->renderer, job, 10 * NS_PER_MS);
            double step_ms = measure_ms(CLOCK_MONOTONIC) - began_ms;
            longest = step_ms > longest ? step_ms : longest;
            longest_work = fmax(longest_work, measure_ms(CLOCK_PROCESS_CPUTIME_ID) - work_began_ms);
        }
        struct frame *frame = renderer_end(bench->renderer, &job);
        if (!frame)
            abort();
        frame_unref(&frame);
        if (i < 0)
            continue;
        longest_ms[i] = longest;
        longest_work_ms[i] = longest_work;
        work_ms[i] = measure_ms(CLOCK_PROCESS_CPUTIME_ID) - worked_ms;
    }
    print_row("render_still_1080p_longest_step_ms", longest_ms, STILL_ROUNDS, 10);
    print_row("render_still_1080p_longest_step_cpu_ms", longest_work_ms, STILL_ROUNDS, 0);
    print_row("render_still_1080p_stepped_cpu_ms", work_ms, STILL_ROUNDS, 0);
}

/* Measures recolouring with a still camera after one reading, or all of them, changed. The time to interpolate the field
   between the sensors (split_view_plan()) is not included. */
static void measure_again(struct demo_scene *bench, enum dress dress, bool all, double goal, const char *time_name, const char *work_name)
{
    struct view view;
    double time_ms[MOST_ROUNDS], work_ms[MOST_ROUNDS];
    view_default(bench->scene, 1920, 1080, &view);
    view.tier = TIER_REFINED;
    put_on(bench, dress, &view);
    for (int i = -2; i < MOVING_ROUNDS; i++) {
        struct reading *readings = bench->snapshot->readings;
        for (size_t tag = 0; tag < (all ? bench->plant->tag_count : 1); tag++)
            readings[tag].value *= i % 2 ? 0.97 : 1 / 0.97;
        struct split_plan *plan = split_view_plan(bench->renderer, &view, bench->snapshot, INT64_MAX);
        double began_ms = measure_ms(CLOCK_MONOTONIC), worked_ms = measure_ms(CLOCK_PROCESS_CPUTIME_ID);
        struct frame *frame = split_view_draw(bench->renderer, plan);
        if (!frame)
            abort();
        if (i >= 0) {
            time_ms[i] = measure_ms(CLOCK_MONOTONIC) - began_ms;
            work_ms[i] = measure_ms(CLOCK_PROCESS_CPUTIME_ID) - worked_ms;
        }
        split_plan_destroy(&plan);
        frame_unref(&frame);
    }
    print_row(time_name, time_ms, MOVING_ROUNDS, goal);
    print_row(work_name, work_ms, MOVING_ROUNDS, 0);
}

int main(void)
{
    struct demo_scene bench = { 0 };
    if (access(DEMO_SCENE_PLANT, R_OK) != 0) {
        fprintf(stderr, "render_bench: %s is not there: run `make demo` first\n", DEMO_SCENE_PLANT);
        print_why(DEMO_SCENE_PLANT " is not prepared");
        return 0;
    }
    if (demo_scene_open(&bench)) {
        fill(bench.snapshot, bench.plant);
        measure_all(&bench, TIER_PREVIEW, MOVING_ROUNDS);
        measure_recolour(&bench);
        measure_all(&bench, TIER_REFINED, STILL_ROUNDS);
        measure_steps(&bench);
        measure_again(&bench, PLAIN, false, 4, "render_still_recolor_1080p_ms", "render_still_recolor_1080p_cpu_ms");
        measure_again(&bench, PLAIN, true, 4, "render_still_recolor_all_1080p_ms", "render_still_recolor_all_1080p_cpu_ms");
        measure_again(&bench, LOGARITHMIC, true, 4, "render_still_recolor_log_1080p_ms", "render_still_recolor_log_1080p_cpu_ms");
        measure_again(&bench, GLOSSY, true, 8, "render_still_recolor_glossy_1080p_ms", "render_still_recolor_glossy_1080p_cpu_ms");
    } else {
        print_why("the demo plant could not be opened or drawn; the log says why");
    }
    demo_scene_close(&bench);
    return 0;
}
