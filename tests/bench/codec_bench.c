/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures encoding and decoding of pictures of the demo plant at 1920x1080; prints one JSON line per quantity. Time and size
   of frames of a moving camera; size of frames of a still camera when 60 tags change once per second; and processor time to
   decode both with the command line's decoders. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "clients/link/decoder.h"
#include "deploy/demo/sim_values.h"
#include "encode/encoder.h"
#include "render/split_view.h"
#include "tests/support/demo_scene.h"
#include "tests/support/measure.h"
#include "value/quality.h"

enum { ORBIT = 30, UPDATES = 5, TAGS = 60 };

struct codec_bench {
    struct demo_scene demo;
    struct sim_values *values;
};

static bool values_init(struct codec_bench *bench)
{
    struct diag diag = { 0 };
    struct sim_map map = { 0 };
    bench->values = sim_values_create(bench->demo.plant, &map, true, &diag);
    diag_print(&diag, stderr);
    diag_finish(&diag);
    return bench->values != NULL;
}

/* Gives new simulated readings to the displayed group's first TAGS tags, or to all tags of the plant if `all`; the other tags
   keep their values. */
static void read_tags(struct codec_bench *bench, int group, bool all)
{
    int left = TAGS;
    bench->demo.snapshot->taken_mono_ns = clock_mono_ns();
    bench->demo.snapshot->taken_utc_ns = clock_utc_ns();
    for (size_t i = 0; i < bench->demo.plant->tag_count; i++) {
        struct reading *reading = &bench->demo.snapshot->readings[i];
        if (!all && (bench->demo.plant->tags[i].group != group || left-- <= 0))
            continue;
        reading->value = sim_values_at(bench->values, i);
        reading->quality = QUALITY_GOOD;
        reading->changes++;
    }
}

static void print_row(const char *name, double value, const char *unit)
{
    printf("{\"name\": \"%s\", \"value\": %.2f, \"p95\": null, \"unit\": \"%s\"}\n", name, value, unit);
    fflush(stdout);
}

/* --- measuring ------------------------------------------------------------------------------------------------------------------- */

static const char *const codecs[] = { "jpeg", "h264" };
enum { CODECS = sizeof(codecs) / sizeof(codecs[0]) };

struct measured {
    struct encoder *encoder; /* NULL: this build lacks the encoder */
    struct frame *before;
    struct decoder *decoder;
    double bytes, ms, cpu_ms, decode_cpu_ms;
    int packets;
};

/* Decodes the picture parts of a packet one after the other and adds the processor time to m. */
static void decode(struct measured *m, const struct packet *packet, const struct frame *frame)
{
    double began_ms = measure_ms(CLOCK_PROCESS_CPUTIME_ID);
    for (int i = 0; i < packet->part_count; i++) {
        const struct packet_part *part = &packet->parts[i];
        struct wire_frame wire = {
            .codec = (uint8_t)packet->codec,
            .flags = packet->key ? WIRE_FLAG_KEY : 0,
            .payload_bytes = (uint32_t)part->count,
            .x_px = (uint16_t)part->x_px,
            .y_px = (uint16_t)part->y_px,
            .width_px = (uint16_t)part->width_px,
            .height_px = (uint16_t)part->height_px,
            .full_width_px = (uint16_t)frame->width_px,
            .full_height_px = (uint16_t)frame->height_px,
        };
        if (!decoder_decode(m->decoder, &wire, packet->bytes + part->begin))
            abort();
    }
    m->decode_cpu_ms += measure_ms(CLOCK_PROCESS_CPUTIME_ID) - began_ms;
}

static void encode(struct measured *m, struct frame *frame, int quality, bool full_chroma)
{
    struct encoder_params params = { .quality = quality, .full_chroma = full_chroma, .before = m->before };
    struct packet *packet = NULL;
    double began_ms = measure_ms(CLOCK_PROCESS_CPUTIME_ID);
    if (encoder_send(m->encoder, frame, &params) != 0)
        abort();
    m->cpu_ms += measure_ms(CLOCK_PROCESS_CPUTIME_ID) - began_ms;
    if (encoder_receive(m->encoder, &packet) == 0) {
        m->bytes += (double)packet->count;
        m->ms += (double)packet->encode_ns / 1e6;
        m->packets++;
        decode(m, packet, frame);
    }
    packet_unref(&packet);
    frame_unref(&m->before);
    m->before = frame_ref(frame);
}

static void forget(struct measured measured[CODECS])
{
    for (int c = 0; c < CODECS; c++) {
        measured[c].bytes = measured[c].ms = measured[c].cpu_ms = measured[c].decode_cpu_ms = 0;
        measured[c].packets = 0;
    }
}

static struct frame *draw(struct codec_bench *bench, const struct view *view)
{
    struct frame *frame = split_view_draw_now(bench->demo.renderer, view, bench->demo.snapshot);
    if (!frame)
        abort();
    return frame;
}

static void measure_orbit(struct codec_bench *bench, struct measured measured[CODECS])
{
    struct view view;
    view_default(bench->demo.scene, 1920, 1080, &view);
    double dx = view.camera.eye_m[0] - view.camera.target_m[0], dy = view.camera.eye_m[1] - view.camera.target_m[1];
    for (int i = 0; i < ORBIT; i++) {
        double angle = i * M_PI / 180;
        view.camera.eye_m[0] = view.camera.target_m[0] + dx * cos(angle) - dy * sin(angle);
        view.camera.eye_m[1] = view.camera.target_m[1] + dx * sin(angle) + dy * cos(angle);
        struct frame *frame = draw(bench, &view);
        if (i == 2)
            forget(measured);
        for (int c = 0; c < CODECS; c++)
            if (measured[c].encoder)
                encode(&measured[c], frame, 78, false);
        frame_unref(&frame);
    }
}

static void measure_updates(struct codec_bench *bench, struct measured measured[CODECS])
{
    struct view view;
    view_default(bench->demo.scene, 1920, 1080, &view);
    view.tier = TIER_REFINED;
    for (int i = 0; i < UPDATES + 1; i++) {
        struct frame *frame = draw(bench, &view);
        if (i == 1)
            forget(measured);
        for (int c = 0; c < CODECS; c++)
            if (measured[c].encoder)
                encode(&measured[c], frame, 92, true);
        frame_unref(&frame);
        sim_values_step(bench->values, 1);
        read_tags(bench, view.field.group, false);
    }
}

static void print_rows(const struct measured measured[CODECS], const char *what, double packets)
{
    for (int c = 0; c < CODECS; c++) {
        char name[64];
        if (!measured[c].encoder || !measured[c].packets)
            continue;
        snprintf(name, sizeof(name), "encode_%s_1080p_%s_kb", codecs[c], what);
        print_row(name, measured[c].bytes / packets / 1000, "kB");
        snprintf(name, sizeof(name), "encode_%s_1080p_%s_ms", codecs[c], what);
        print_row(name, measured[c].ms / packets, "ms");
        snprintf(name, sizeof(name), "encode_%s_1080p_%s_cpu_ms", codecs[c], what);
        print_row(name, measured[c].cpu_ms / packets, "ms");
        snprintf(name, sizeof(name), "decode_%s_1080p_%s_cpu_ms", codecs[c], what);
        print_row(name, measured[c].decode_cpu_ms / packets, "ms");
    }
}

static void measure(struct codec_bench *bench)
{
    struct measured measured[CODECS] = { { 0 } };
    for (int c = 0; c < CODECS; c++)
        if (encoder_works(bench->demo.log, codecs[c], ENCODER_H264_LIBRARY)) {
            measured[c].encoder = encoder_create(bench->demo.log, codecs[c], ENCODER_H264_LIBRARY);
            measured[c].decoder = decoder_create();
        }
    for (int i = 0; i < 60; i++)
        sim_values_step(bench->values, 1);
    read_tags(bench, -1, true);
    measure_orbit(bench, measured);
    print_rows(measured, "orbit", ORBIT - 2);
    measure_updates(bench, measured);
    print_rows(measured, "update", UPDATES);
    for (int c = 0; c < CODECS; c++) {
        frame_unref(&measured[c].before);
        encoder_destroy(&measured[c].encoder);
        decoder_destroy(&measured[c].decoder);
    }
}

int main(void)
{
    struct codec_bench bench = { 0 };
    if (access(DEMO_SCENE_PLANT, R_OK) != 0) {
        printf("{\"name\": \"encode_jpeg_1080p_orbit_ms\", \"value\": null, \"p95\": null, \"unit\": \"ms\", \"why\": \"%s is not "
               "prepared\"}\n",
               DEMO_SCENE_PLANT);
        return 0;
    }
    bool good = demo_scene_open(&bench.demo) && values_init(&bench);
    if (good)
        measure(&bench);
    sim_values_destroy(&bench.values);
    demo_scene_close(&bench.demo);
    return good ? 0 : 1;
}
