/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast-video`: streams a view of a daemon as video. At each tick it draws a frame (a picture or a text card) and encodes it once
   for all outputs. */
#include <glib-unix.h>
#include <locale.h>
#include <signal.h>
#include <stdio.h>

#include "base/system/service_manager.h"
#include "branch.h"
#include "encoder.h"
#include "metrics.h"
#include "render/overlay/overlay_words.h"
#include "render/overlay/text_face.h"
#include "rtsp.h"
#include "source.h"

struct video_program {
    struct video_options options;
    GMainLoop *loop;
    struct canvas canvas;
    struct video_source *source;
    struct outputs *outputs;
    struct video_encoder *encoder;
    struct rtsp *rtsp;
    struct video_branch srt;
    struct metrics *metrics; /* NULL: metrics are off */
    bool card;               /* true: the newest frame shows a text card instead of the picture */
    GSource *ticks;
    gint64 begin_us, alive_us;
    guint64 next; /* number of the next frame */
    guint64 late; /* number of frames skipped because the frame timer fired late */
    int code;
};

/* --- counters ------------------------------------------------------------------------------------------------------------------------ */

static void add_metric(GString *out, const char *name, const char *type, const char *help, guint64 value)
{
    g_string_append_printf(out, "# HELP %s %s\n# TYPE %s %s\n%s %" G_GUINT64_FORMAT "\n", name, help, name, type, name, value);
}

static void tell_metrics(struct video_program *program)
{
    GString *out = g_string_new("");
    struct outputs_counts counts;
    outputs_count(program->outputs, &counts);
    add_metric(out, "plantcast_video_frames_total", "counter", "Video frames encoded; each frame is encoded once for all viewers.",
               counts.units);
    add_metric(out, "plantcast_video_key_frames_total", "counter", "Key frames encoded.", counts.key_units);
    add_metric(out, "plantcast_video_bytes_total", "counter", "Bytes of encoded frames.", counts.bytes);
    add_metric(out, "plantcast_video_late_frames_total", "counter", "Video frames skipped because drawing or encoding was late.",
               program->late);
    add_metric(out, "plantcast_video_dropped_frames_total", "counter",
               "Video frames dropped because an output (RTSP or SRT) was not ready.", counts.dropped);
    add_metric(out, "plantcast_video_pictures_total", "counter", "Pictures received from the plant's daemon.",
               source_pictures(program->source));
    add_metric(out, "plantcast_video_card", "gauge",
               "1 while the video shows a message instead of the plant, for example because the daemon does not answer.", program->card);
    g_string_append_printf(out,
                           "# HELP plantcast_video_readers Connected viewers.\n# TYPE plantcast_video_readers gauge\n"
                           "plantcast_video_readers{output=\"rtsp\"} %u\nplantcast_video_readers{output=\"srt\"} %d\n",
                           rtsp_readers(program->rtsp), g_atomic_int_get(&program->srt.readers));
    metrics_set(program->metrics, g_string_free(out, FALSE));
}

/* --- frames ------------------------------------------------------------------------------------------------------------------------ */

static void draw(struct video_program *program, guint64 index)
{
    int stride_bytes = program->options.width_px * 4;
    struct shown look;
    GstMapInfo map;
    source_look(program->source, &look);
    program->card = !look.picture;
    if (!encoder_is_ready(program->encoder)) {
        program->late++;
        return;
    }
    GstBuffer *pixels = gst_buffer_new_allocate(NULL, (gsize)stride_bytes * (gsize)program->options.height_px, NULL);
    if (!pixels || !gst_buffer_map(pixels, &map, GST_MAP_WRITE)) {
        gst_clear_buffer(&pixels);
        program->late++;
        return;
    }
    canvas_draw(&program->canvas, map.data, stride_bytes, &look, g_get_real_time());
    gst_buffer_unmap(pixels, &map);
    encoder_add(program->encoder, pixels, index);
}

static gint64 time_of(const struct video_program *program, guint64 index)
{
    return program->begin_us + (gint64)(index * G_USEC_PER_SEC / (guint64)program->options.fps);
}

/* Draws the frame that is due now. Frames missed by a late timer are skipped. */
static gboolean on_tick(gpointer data)
{
    struct video_program *program = data;
    gint64 now_us = g_get_monotonic_time();
    guint64 index = (guint64)(now_us - program->begin_us) * (guint64)program->options.fps / G_USEC_PER_SEC;
    if (index < program->next) /* the timer fired slightly early: draws the next frame anyway, because it is almost due */
        index = program->next;
    program->late += index - program->next;
    draw(program, index);
    if (program->metrics)
        tell_metrics(program);
    program->next = index + 1;
    g_source_set_ready_time(program->ticks, time_of(program, program->next));
    if (now_us - program->alive_us > G_USEC_PER_SEC) {
        program->alive_us = now_us;
        service_notify("WATCHDOG=1");
        branch_look(&program->srt);
        if (!encoder_is_good(program->encoder)) {
            program->code = 1;
            g_main_loop_quit(program->loop);
        }
    }
    return G_SOURCE_CONTINUE;
}

static gboolean dispatch(GSource *source, GSourceFunc callback, gpointer data)
{
    (void)source;
    return callback(data);
}

static void begin_ticks(struct video_program *program)
{
    static GSourceFuncs funcs = { .dispatch = dispatch };
    gint64 rest_us = g_get_real_time() % G_USEC_PER_SEC; /* aligns the timer to UTC seconds, so that several instances of this
                                                            program draw at the same instants */
    program->begin_us = g_get_monotonic_time() + G_USEC_PER_SEC - rest_us;
    program->ticks = g_source_new(&funcs, sizeof(GSource));
    g_source_set_callback(program->ticks, on_tick, program, NULL);
    g_source_set_ready_time(program->ticks, program->begin_us);
    g_source_attach(program->ticks, NULL);
}

/* --- start and stop ------------------------------------------------------------------------------------------------------------------ */

static gboolean on_signal(gpointer data)
{
    g_main_loop_quit(((struct video_program *)data)->loop);
    return G_SOURCE_CONTINUE;
}

static bool begin(struct video_program *program)
{
    const struct video_options *options = &program->options;
    program->canvas = (struct canvas){ .width_px = options->width_px, .height_px = options->height_px, .time_code = options->time_code };
    program->outputs = outputs_create();
    if (options->srt_port)
        srt_init(&program->srt, options, program->outputs);
    return (program->source = source_create(options)) && (program->encoder = encoder_create(options, program->outputs)) &&
           (!options->rtsp_port || (program->rtsp = rtsp_create(options, program->outputs))) &&
           (!options->srt_port || branch_begin(&program->srt)) &&
           (!options->http_port || (program->metrics = metrics_create(options->http_port)));
}

static void end(struct video_program *program)
{
    if (program->ticks) {
        g_source_destroy(program->ticks);
        g_source_unref(program->ticks);
    }
    metrics_destroy(&program->metrics);
    rtsp_destroy(&program->rtsp);
    branch_end(&program->srt);
    encoder_destroy(&program->encoder);
    source_destroy(&program->source);
    outputs_destroy(&program->outputs);
    g_main_loop_unref(program->loop);
}

static int serve_video(struct video_program *program)
{
    program->loop = g_main_loop_new(NULL, FALSE);
    program->code = begin(program) ? 0 : 1;
    if (program->code == 0) {
        g_unix_signal_add(SIGTERM, on_signal, program);
        g_unix_signal_add(SIGINT, on_signal, program);
        begin_ticks(program);
        printf("plantcast-video: ready\n");
        fflush(stdout);
        service_notify("READY=1");
        g_main_loop_run(program->loop);
        service_notify("STOPPING=1");
    }
    end(program);
    return program->code;
}

int main(int argc, char **argv)
{
    struct video_program program = { 0 };
    setlocale(LC_CTYPE, "");
    signal(SIGPIPE, SIG_IGN);
    int code = options_read(&program.options, &argc, &argv);
    if (code < 0) {
        if (!text_face_has(overlay_word(program.options.words, WORD_NO_DATA)))
            fprintf(stderr, "plantcast-video: no installed font has the letters of --language %s, so the picture shows boxes: install "
                            "fonts-nanum\n",
                    program.options.language);
        gst_init(NULL, NULL);
        code = serve_video(&program);
    }
    options_finish(&program.options);
    return code;
}
