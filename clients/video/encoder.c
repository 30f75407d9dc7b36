/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Encodes BGRX to H.264 with x264 without frame reordering: each frame gives one access unit. */
#include "encoder.h"

#include <gst/app/gstappsink.h>
#include <stdio.h>

enum { KEY_S = 2, MAX_WAITING = 2 };

struct video_encoder {
    GstElement *pipeline;
    GstAppSrc *in;
    struct outputs *outputs;
    int fps;
    guint64 groups; /* number of groups of pictures that were encoded; each group begins with a key frame */
    guint64 frame_bytes;
};

static GstFlowReturn on_unit(GstAppSink *sink, gpointer data)
{
    struct video_encoder *encoder = data;
    GstSample *sample = gst_app_sink_pull_sample(sink);
    if (!sample)
        return GST_FLOW_EOS;
    outputs_push(encoder->outputs, gst_sample_get_buffer(sample));
    gst_sample_unref(sample);
    return GST_FLOW_OK;
}

struct video_encoder *encoder_create(const struct video_options *options, struct outputs *outputs)
{
    GError *error = NULL;
    char *text = g_strdup_printf(
        "appsrc name=in is-live=true format=time block=false max-bytes=0 caps=video/x-raw,format=BGRx,width=%d,height=%d,framerate=%d/1 ! "
        "videoconvert ! video/x-raw,format=I420,colorimetry=bt709 ! "
        "x264enc tune=zerolatency sliced-threads=false threads=1 speed-preset=veryfast pass=qual quantizer=21 bitrate=%d key-int-max=%d "
        "option-string=scenecut=0 aud=true ! "
        "video/x-h264,profile=constrained-baseline ! h264parse config-interval=-1 ! " OUTPUTS_CAPS " ! "
        "appsink name=out sync=false max-buffers=0",
        options->width_px, options->height_px, options->fps, options->kbps, 2 * KEY_S * options->fps);
    GstElement *pipeline = gst_parse_launch(text, &error);
    g_free(text);
    if (error) {
        fprintf(stderr, "plantcast-video: cannot encode H.264: %s; install the package gstreamer1.0-plugins-ugly\n", error->message);
        g_clear_error(&error);
        gst_clear_object(&pipeline);
        return NULL;
    }
    struct video_encoder *encoder = g_new0(struct video_encoder, 1);
    encoder->pipeline = pipeline;
    encoder->in = GST_APP_SRC(gst_bin_get_by_name(GST_BIN(pipeline), "in"));
    encoder->outputs = outputs;
    encoder->fps = options->fps;
    encoder->frame_bytes = (guint64)options->width_px * (guint64)options->height_px * 4;
    GstElement *out = gst_bin_get_by_name(GST_BIN(pipeline), "out");
    gst_app_sink_set_callbacks(GST_APP_SINK(out), &(GstAppSinkCallbacks){ .new_sample = on_unit }, encoder, NULL);
    gst_object_unref(out);
    gst_element_set_state(pipeline, GST_STATE_PLAYING);
    return encoder;
}

void encoder_destroy(struct video_encoder **pointer)
{
    struct video_encoder *encoder = *pointer;
    if (!encoder)
        return;
    gst_element_set_state(encoder->pipeline, GST_STATE_NULL);
    gst_object_unref(encoder->in);
    gst_object_unref(encoder->pipeline);
    g_free(encoder);
    *pointer = NULL;
}

bool encoder_is_ready(const struct video_encoder *encoder)
{
    return gst_app_src_get_current_level_bytes(encoder->in) < MAX_WAITING * encoder->frame_bytes;
}

/* Requests a key frame every KEY_S seconds of video time, even if frames were dropped in between, so that viewers can join. */
static void ask_for_key(struct video_encoder *encoder)
{
    GstStructure *structure = gst_structure_new("GstForceKeyUnit", "timestamp", G_TYPE_UINT64, GST_CLOCK_TIME_NONE, "stream-time",
                                                G_TYPE_UINT64, GST_CLOCK_TIME_NONE, "running-time", G_TYPE_UINT64, GST_CLOCK_TIME_NONE,
                                                "all-headers", G_TYPE_BOOLEAN, TRUE, "count", G_TYPE_UINT, 0u, NULL);
    gst_element_send_event(GST_ELEMENT(encoder->in), gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM, structure));
}

void encoder_add(struct video_encoder *encoder, GstBuffer *pixels, guint64 index)
{
    guint64 group = index / (guint64)(KEY_S * encoder->fps) + 1;
    if (group != encoder->groups)
        ask_for_key(encoder);
    encoder->groups = group;
    GST_BUFFER_PTS(pixels) = gst_util_uint64_scale(index, GST_SECOND, (guint64)encoder->fps);
    GST_BUFFER_DURATION(pixels) = GST_SECOND / (guint64)encoder->fps;
    gst_app_src_push_buffer(encoder->in, pixels);
}

bool encoder_is_good(struct video_encoder *encoder)
{
    GstBus *bus = gst_element_get_bus(encoder->pipeline);
    GstMessage *message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR);
    if (message) {
        GError *error = NULL;
        gst_message_parse_error(message, &error, NULL);
        fprintf(stderr, "plantcast-video: H.264: %s\n", error->message);
        g_error_free(error);
        gst_message_unref(message);
    }
    gst_object_unref(bus);
    return !message;
}
