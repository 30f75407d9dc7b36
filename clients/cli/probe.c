/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast probe`: many viewers at once, and a table of what they saw. */
#include <getopt.h>
#include <jansson.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "commands.h"
#include "decoder.h"
#include "viewer.h"

enum { MAX_SESSIONS = 1000 };

struct probe {
    struct daemon_url url;
    const char *url_text;
    int sessions, width_px, height_px;
    double seconds;
    enum motion motion;
    bool as_json;
    const char *codec;
    struct viewer **viewers;
};

static const char *const stage_names[STAGE_COUNT] = { "wait", "field", "render", "encode", "decode" };
static const char *const motion_names[] = { "still", "orbit" };

static void print_usage(FILE *out)
{
    fputs("usage: plantcast probe URL [--sessions N] [--seconds S] [--motion still|orbit] [--size WxH]\n"
          "                           [--codec jpeg|h264] [--json]\n"
          "\n"
          "Opens N sessions on a daemon (http://HOST:PORT/), decodes every frame before it acknowledges it, and prints rates and\n"
          "latencies. Input to frame: from sending a camera to the first frame drawn with it, or with a newer one, decoded; each of\n"
          "the 60 cameras that an orbit sends in a second counts. `steady` is what comes, texts and all, once 3 s have gone by.\n",
          out);
}

/* --- numbers ------------------------------------------------------------------------------------------------------------------ */

static int ascending(const void *pa, const void *pb)
{
    double a = *(const double *)pa, b = *(const double *)pb;
    return (a > b) - (a < b);
}

static void append(struct samples *all, const struct samples *some)
{
    mem_grow(&all->at, &all->capacity, all->count + some->count, sizeof(*all->at));
    if (some->count)
        memcpy(all->at + all->count, some->at, some->count * sizeof(*all->at));
    all->count += some->count;
}

/* of: sorted. NaN: none. */
static double percentile(const struct samples *of, double p)
{
    if (!of->count)
        return NAN;
    return of->at[(size_t)ceil(p / 100 * (double)of->count) - (p > 0)];
}

static void sort(struct samples *samples)
{
    if (samples->count)
        qsort(samples->at, samples->count, sizeof(*samples->at), ascending);
}

struct summary {
    int frames, still_frames, errors, failed;
    double fps, fps_lowest; /* mean and least over the sessions */
    double kb_per_frame, mbit_per_s, steady_kbit_per_s;
    struct samples input, first, stages[STAGE_COUNT];
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
    for (int i = 0; i < probe->sessions; i++) {
        const struct viewer_result *result = viewer_result(probe->viewers[i]);
        double fps = fps_of(result);
        sum->frames += result->frames;
        sum->still_frames += result->still_frames;
        sum->errors += result->errors;
        sum->failed += result->failure[0] != 0;
        sum->fps += fps / probe->sessions;
        sum->fps_lowest = fmin(sum->fps_lowest, fps);
        bytes += (double)result->bytes;
        text_bytes += (double)result->text_bytes;
        steady_bytes += (double)result->steady_bytes;
        append(&sum->input, &result->input);
        append(&sum->first, &result->first);
        for (int s = 0; s < STAGE_COUNT; s++)
            append(&sum->stages[s], &result->stages[s]);
    }
    sum->kb_per_frame = sum->frames ? bytes / sum->frames / 1000 : 0;
    sum->steady_kbit_per_s = probe->seconds > VIEWER_SETTLES_S ? steady_bytes * 8 / 1000 / (probe->seconds - VIEWER_SETTLES_S) : 0;
    sum->mbit_per_s = (bytes + text_bytes) * 8 / 1e6 / probe->seconds;
    sort(&sum->input);
    sort(&sum->first);
    for (int s = 0; s < STAGE_COUNT; s++)
        sort(&sum->stages[s]);
}

static void summary_finish(struct summary *sum)
{
    mem_free(sum->input.at);
    mem_free(sum->first.at);
    for (int s = 0; s < STAGE_COUNT; s++)
        mem_free(sum->stages[s].at);
}

/* --- what is printed ---------------------------------------------------------------------------------------------------------- */

static void print_row(const char *name, const struct samples *samples)
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
           motion_names[probe->motion], probe->codec, probe->width_px, probe->height_px, probe->seconds);
    printf("  frames           %8d (%d refined)\n", sum->frames, sum->still_frames);
    printf("  frames/s         %8.1f per session, lowest %.1f\n", sum->fps, sum->fps_lowest);
    printf("  kB/frame         %8.1f\n", sum->kb_per_frame);
    printf("  Mbit/s           %8.2f together\n", sum->mbit_per_s);
    if (probe->seconds > VIEWER_SETTLES_S)
        printf("  steady           %8.1f kbit/s together\n", sum->steady_kbit_per_s);
    if (sum->errors)
        printf("  error messages   %8d\n", sum->errors);
    printf("  %-16s %8s %8s %8s %8s\n", "", "p50", "p95", "p99", "max");
    print_row("input to frame", &sum->input);
    for (int s = 0; s < STAGE_COUNT; s++)
        print_row(stage_names[s], &sum->stages[s]);
    print_row("first frame", &sum->first);
}

static json_t *samples_json(const struct samples *samples)
{
    if (!samples->count)
        return json_null();
    return json_pack("{s:f,s:f,s:f,s:f,s:I}", "p50", percentile(samples, 50), "p95", percentile(samples, 95), "p99",
                     percentile(samples, 99), "max", percentile(samples, 100), "count", (json_int_t)samples->count);
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
                          "motion", motion_names[probe->motion], "width", probe->width_px, "height", probe->height_px);
    json_object_update_new(o, json_pack("{s:s,s:i,s:i,s:i,s:f,s:f,s:f,s:f,s:f}", "codec", probe->codec, "frames", sum->frames,
                                        "still_frames", sum->still_frames, "errors", sum->errors, "fps", sum->fps, "fps_lowest",
                                        sum->fps_lowest, "kb_per_frame", sum->kb_per_frame, "mbit_per_s", sum->mbit_per_s,
                                        "steady_kbit_per_s", sum->steady_kbit_per_s));
    json_object_set_new(o, "input_to_frame_ms", samples_json(&sum->input));
    json_object_set_new(o, "first_frame_ms", samples_json(&sum->first));
    json_object_set_new(o, "stages_ms", stages);
    json_object_set_new(o, "failures", failures);
    char *text = json_dumps(o, JSON_INDENT(2) | JSON_REAL_PRECISION(6));
    puts(text ? text : "{}");
    free(text);
    json_decref(o);
}

/* --- the run ------------------------------------------------------------------------------------------------------------------ */

static void *viewer_main(void *arg)
{
    viewer_run(arg);
    return NULL;
}

static bool run_viewers(struct probe *probe)
{
    pthread_t *threads = mem_array((size_t)probe->sessions, sizeof(*threads));
    int started = 0;
    probe->viewers = mem_array((size_t)probe->sessions, sizeof(*probe->viewers));
    for (int i = 0; i < probe->sessions; i++) {
        struct viewer_params params = { .url = &probe->url,
                                        .width_px = probe->width_px,
                                        .height_px = probe->height_px,
                                        .motion = probe->motion,
                                        .codec = probe->codec,
                                        .seconds = probe->seconds,
                                        .start_deg = 360.0 * i / probe->sessions };
        if (!(probe->viewers[i] = viewer_create(&params)))
            goto done;
    }
    for (; started < probe->sessions; started++)
        if (pthread_create(&threads[started], NULL, viewer_main, probe->viewers[started]) != 0)
            break;
done:
    for (int i = 0; i < started; i++)
        pthread_join(threads[i], NULL);
    mem_free(threads);
    if (started < probe->sessions)
        fprintf(stderr, "plantcast: only %d of %d sessions could be started\n", started, probe->sessions);
    return started == probe->sessions;
}

static int run(struct probe *probe)
{
    bool good = run_viewers(probe);
    if (good) {
        struct summary sum;
        summarise(probe, &sum);
        if (probe->as_json)
            print_json(probe, &sum);
        else if (sum.frames > 0)
            print_table(probe, &sum);
        print_failures(probe);
        good = sum.failed == 0 && sum.frames > 0;
        summary_finish(&sum);
    }
    for (int i = 0; i < probe->sessions; i++)
        viewer_destroy(&probe->viewers[i]);
    mem_free(probe->viewers);
    return good ? 0 : 1;
}

static bool parse_size(const char *text, int *w, int *h)
{
    char rest;
    return sscanf(text, "%dx%d%c", w, h, &rest) == 2 && *w >= 16 && *h >= 16 && *w <= 8192 && *h <= 8192;
}

static bool take_option(int option, struct probe *probe)
{
    char *end = "";
    switch (option) {
    case 'n': probe->sessions = (int)strtol(optarg, &end, 10); return !*end && probe->sessions >= 1 && probe->sessions <= MAX_SESSIONS;
    case 's': probe->seconds = strtod(optarg, &end); return !*end && probe->seconds > 0 && probe->seconds <= 1e6;
    case 'm':
        probe->motion = strcmp(optarg, "orbit") == 0 ? MOTION_ORBIT : MOTION_STILL;
        return !strcmp(optarg, motion_names[probe->motion]);
    case 'z': return parse_size(optarg, &probe->width_px, &probe->height_px);
    case 'c': probe->codec = optarg; return !strcmp(optarg, "jpeg") || (!strcmp(optarg, "h264") && decoder_has(WIRE_CODEC_H264));
    case 'j': probe->as_json = true; return true;
    default: return false;
    }
}

int cmd_probe(int argc, char **argv)
{
    static const struct option options[] = {
        { "sessions", required_argument, NULL, 'n' },
        { "seconds", required_argument, NULL, 's' },
        { "motion", required_argument, NULL, 'm' },
        { "size", required_argument, NULL, 'z' },
        { "codec", required_argument, NULL, 'c' },
        { "json", no_argument, NULL, 'j' },
        { "help", no_argument, NULL, 'h' },
        { NULL, 0, NULL, 0 },
    };
    struct probe probe = { .sessions = 1, .codec = "jpeg", .seconds = 5, .motion = MOTION_ORBIT, .width_px = 1280, .height_px = 720 };
    for (int option; (option = getopt_long(argc, argv, "", options, NULL)) != -1;) {
        if (option == 'h') {
            print_usage(stdout);
            return 0;
        }
        if (!take_option(option, &probe)) {
            if (option != '?')
                fprintf(stderr, "plantcast: probe: '%s' is not good there\n", optarg);
            print_usage(stderr);
            return 2;
        }
    }
    if (optind + 1 != argc) {
        print_usage(stderr);
        return 2;
    }
    probe.url_text = argv[optind];
    return daemon_url_parse(probe.url_text, &probe.url) ? run(&probe) : 2;
}
