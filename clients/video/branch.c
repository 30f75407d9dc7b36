/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Starts the GStreamer pipeline of one output, such as SRT, watches it, and restarts it after a failure. */
#include "branch.h"

#include <stdio.h>

static const gint64 WAIT_US = 5 * G_USEC_PER_SEC;

static void drop(struct video_branch *branch)
{
    if (!branch->pipeline)
        return;
    GstElement *in = gst_bin_get_by_name(GST_BIN(branch->pipeline), "in");
    outputs_remove(branch->outputs, GST_APP_SRC(in));
    gst_object_unref(in);
    gst_element_set_state(branch->pipeline, GST_STATE_NULL);
    gst_clear_object(&branch->pipeline);
    g_atomic_int_set(&branch->readers, 0);
}

/* Returns true if the pipeline has reported an error, and prints the error. */
static bool has_failed(struct video_branch *branch)
{
    GstBus *bus = gst_element_get_bus(branch->pipeline);
    GstMessage *message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR);
    gst_object_unref(bus);
    if (!message)
        return false;
    GError *error = NULL;
    char *detail = NULL;
    gst_message_parse_error(message, &error, &detail);
    fprintf(stderr, "plantcast-video: %s: %s %s\n", branch->name, error->message, detail ? detail : "");
    g_error_free(error);
    g_free(detail);
    gst_message_unref(message);
    return true;
}

bool branch_begin(struct video_branch *branch)
{
    GError *error = NULL;
    char *text = g_strdup_printf(OUTPUTS_SOURCE " ! %s", branch->text);
    branch->pipeline = gst_parse_launch(text, &error);
    g_free(text);
    if (error) {
        fprintf(stderr, "plantcast-video: the output %s cannot start: %s; install the package gstreamer1.0-plugins-bad\n", branch->name,
                error->message);
        g_clear_error(&error);
        gst_clear_object(&branch->pipeline);
        return false;
    }
    branch->prepare(branch, branch->pipeline);
    if (gst_element_set_state(branch->pipeline, GST_STATE_PLAYING) == GST_STATE_CHANGE_FAILURE) {
        if (!has_failed(branch))
            fprintf(stderr, "plantcast-video: the output %s cannot start: GStreamer names no reason\n", branch->name);
        gst_element_set_state(branch->pipeline, GST_STATE_NULL);
        gst_clear_object(&branch->pipeline);
        return false;
    }
    GstElement *in = gst_bin_get_by_name(GST_BIN(branch->pipeline), "in");
    outputs_add(branch->outputs, GST_APP_SRC(in));
    gst_object_unref(in);
    return true;
}

void branch_look(struct video_branch *branch)
{
    gint64 now_us = g_get_monotonic_time();
    if (branch->pipeline && has_failed(branch)) {
        drop(branch);
        branch->again_us = now_us + WAIT_US;
    } else if (branch->text && !branch->pipeline && now_us > branch->again_us) {
        branch->again_us = now_us + WAIT_US;
        if (branch_begin(branch))
            fprintf(stderr, "plantcast-video: %s: restarted\n", branch->name);
    }
}

void branch_end(struct video_branch *branch)
{
    drop(branch);
    g_clear_pointer(&branch->text, g_free);
}
