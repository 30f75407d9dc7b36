/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints a probe's results as a table or as JSON. */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/math/search.h"
#include "base/mem.h"
#include "probe.h"
#include "stream_reach.h"

const char *const probe_motions[MOTION_COUNT] = { "still", "orbit", "random" };
static const char *const stage_names[STAGE_COUNT] = { "wait", "field", "render", "encode", "network", "decode" };

static void append(struct latency_samples *all, const struct latency_samples *some)
{
    mem_grow(&all->at, &all->capacity, all->count + some->count, sizeof(*all->at));
    if (some->count)
        memcpy(all->at + all->count, some->at, some->count * sizeof(*all->at));
    all->count += some->count;
}

/* Returns the p-th percentile of sorted samples; NaN if there are none. */
static double percentile(const struct latency_samples *of, double p)
{
    if (!of->count)
        return NAN;
    return of->at[(size_t)ceil(p / 100 * (double)of->count) - (p > 0)];
}

static void sort(struct latency_samples *samples)
{
    if (samples->count)
        qsort(samples->at, samples->count, sizeof(*samples->at), compare_doubles);
}

struct summary {
    int frames, still_frames, signed_frames, errors, failed, given_up;
    double fps, fps_lowest; /* frame rate in frames per second: mean and lowest of all sessions */
    double kb_per_frame, mbit_per_s, steady_kbit_per_s;
    struct latency_samples input, sensor, behind, first, stages[STAGE_COUNT];
};

static double fps_of(const struct viewer_result *result)
{
    double seconds = (double)(result->last_ns - result->first_ns) / 1e9;
    return result->frames > 1 && seconds > 0 ? (result->frames - 1) / seconds : 0;
}

static void summarise(const struct probe *probe, struct summary *sum)
{
    double bytes = 0, text_bytes = 0, steady_bytes = 0;
    *sum = (struct summary){ .fps_lowest = INFINITY };
    for (int i = 0; i < probe->watching; i++) {
        const struct viewer_result *result = viewer_result(probe->viewers[i]);
        double fps = fps_of(result);
        sum->frames += result->frames;
        sum->still_frames += result->still_frames;
        sum->signed_frames += result->signed_frames;
        sum->errors += result->errors;
        sum->failed += result->failure[0] != 0;
        sum->fps += fps / probe->watching;
        sum->fps_lowest = fmin(sum->fps_lowest, fps);
        bytes += (double)result->bytes;
        text_bytes += (double)result->text_bytes;
        steady_bytes += (double)result->steady_bytes;
        sum->given_up += result->given_up;
        append(&sum->input, &result->input);
        append(&sum->sensor, &result->sensor);
        append(&sum->behind, &result->behind);
        append(&sum->first, &result->first);
        for (int s = 0; s < STAGE_COUNT; s++)
            append(&sum->stages[s], &result->stages[s]);
    }
    sum->kb_per_frame = sum->frames ? bytes / sum->frames / 1000 : 0;
    sum->steady_kbit_per_s = probe->seconds > VIEWER_SETTLES_S ? steady_bytes * 8 / 1000 / (probe->seconds - VIEWER_SETTLES_S) : 0;
    sum->mbit_per_s = (bytes + text_bytes) * 8 / 1e6 / probe->seconds;
    sort(&sum->input);
    sort(&sum->sensor);
    sort(&sum->behind);
    sort(&sum->first);
    for (int s = 0; s < STAGE_COUNT; s++)
        sort(&sum->stages[s]);
}

static void summary_finish(struct summary *sum)
{
    mem_free(sum->input.at);
    mem_free(sum->sensor.at);
    mem_free(sum->behind.at);
    mem_free(sum->first.at);
    for (int s = 0; s < STAGE_COUNT; s++)
        mem_free(sum->stages[s].at);
}

/* --- printing ----------------------------------------------------------------------------------------------------------------- */

static void print_row(const char *name, const struct latency_samples *samples)
{
    if (samples->count)
        printf("  %-16s %8.1f %8.1f %8.1f %8.1f   ms\n", name, percentile(samples, 50), percentile(samples, 95), percentile(samples, 99),
               percentile(samples, 100));
    else
        printf("  %-16s %8s %8s %8s %8s\n", name, "-", "-", "-", "-");
}

static void print_failures(const struct probe *probe)
{
    for (int i = 0; i < probe->sessions; i++)
        if (viewer_result(probe->viewers[i])->failure[0])
            fprintf(stderr, "plantcast: session %d: %s\n", i + 1, viewer_result(probe->viewers[i])->failure);
}

static void print_table(const struct probe *probe, const struct summary *sum)
{
    printf("%s  %d session%s, %s, %s, %dx%d, %.1f s\n", probe->url_text, probe->sessions, probe->sessions == 1 ? "" : "s",
           probe_motions[probe->motion], probe->codec, probe->width_px, probe->height_px, probe->seconds);
    printf("  frames           %8d (%d refined)\n", sum->frames, sum->still_frames);
    if (probe->signs)
        printf("  signed           %8d\n", sum->signed_frames);
    printf("  frames/s         %8.1f per session, lowest %.1f\n", sum->fps, sum->fps_lowest);
    printf("  kB/frame         %8.1f\n", sum->kb_per_frame);
    printf("  Mbit/s           %8.2f in total\n", sum->mbit_per_s);
    if (probe->seconds > VIEWER_SETTLES_S)
        printf("  steady           %8.1f kbit/s in total\n", sum->steady_kbit_per_s);
    if (sum->errors)
        printf("  error messages   %8d\n", sum->errors);
    printf("  %-16s %8s %8s %8s %8s\n", "", "p50", "p95", "p99", "max");
    print_row("input to frame", &sum->input);
    print_row("sensor to frame", &sum->sensor);
    if (sum->behind.count)
        print_row("behind leader", &sum->behind);
    for (int s = 0; s < STAGE_COUNT; s++)
        print_row(stage_names[s], &sum->stages[s]);
    print_row("first frame", &sum->first);
}

static json_t *samples_json(const struct latency_samples *samples)
{
    if (!samples->count)
        return json_null();
    return json_pack("{s:f,s:f,s:f,s:f,s:I}", "p50", percentile(samples, 50), "p95", percentile(samples, 95), "p99",
                     percentile(samples, 99), "max", percentile(samples, 100), "count", (json_int_t)samples->count);
}

static json_t *fps_json(const struct probe *probe)
{
    json_t *list = json_array();
    for (int i = 0; i < probe->watching; i++)
        json_array_append_new(list, json_real(fps_of(viewer_result(probe->viewers[i]))));
    return list;
}

static void print_json(const struct probe *probe, const struct summary *sum)
{
    json_t *stages = json_object(), *failures = json_array();
    for (int s = 0; s < STAGE_COUNT; s++)
        json_object_set_new(stages, stage_names[s], samples_json(&sum->stages[s]));
    for (int i = 0; i < probe->sessions; i++)
        if (viewer_result(probe->viewers[i])->failure[0])
            json_array_append_new(failures, json_string(viewer_result(probe->viewers[i])->failure));
    json_t *o = json_pack("{s:s,s:i,s:f,s:s,s:i,s:i}", "url", probe->url_text, "sessions", probe->sessions, "seconds", probe->seconds,
                          "motion", probe_motions[probe->motion], "width", probe->width_px, "height", probe->height_px);
    json_object_update_new(o, json_pack("{s:s,s:i,s:i,s:i,s:i,s:f,s:f,s:f,s:f,s:f}", "codec", probe->codec, "frames", sum->frames,
                                        "still_frames", sum->still_frames, "signed_frames", sum->signed_frames, "errors", sum->errors,
                                        "fps", sum->fps, "fps_lowest", sum->fps_lowest, "kb_per_frame", sum->kb_per_frame, "mbit_per_s",
                                        sum->mbit_per_s, "steady_kbit_per_s", sum->steady_kbit_per_s));
    json_object_set_new(o, "given_up", json_integer(sum->given_up));
    json_object_set_new(o, "sessions_fps", fps_json(probe));
    json_object_set_new(o, "input_to_frame_ms", samples_json(&sum->input));
    json_object_set_new(o, "sensor_to_frame_ms", samples_json(&sum->sensor));
    json_object_set_new(o, "behind_leader_ms", samples_json(&sum->behind));
    json_object_set_new(o, "first_frame_ms", samples_json(&sum->first));
    json_object_set_new(o, "stages_ms", stages);
    json_object_set_new(o, "failures", failures);
    char *text = json_dumps(o, JSON_INDENT(2) | JSON_REAL_PRECISION(6));
    puts(text ? text : "{}");
    free(text);
    json_decref(o);
}

bool probe_report(const struct probe *probe)
{
    struct summary sum;
    summarise(probe, &sum);
    if (probe->as_json)
        print_json(probe, &sum);
    else if (sum.frames > 0)
        print_table(probe, &sum);
    print_failures(probe);
    if (sum.failed > 0 && sum.frames == 0)
        stream_is_blocked(&probe->url);
    bool good = sum.failed == 0 && sum.frames > 0;
    summary_finish(&sum);
    return good;
}
