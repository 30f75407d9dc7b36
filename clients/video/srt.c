/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sends the video as MPEG-TS to any number of SRT clients. */
#include <gio/gio.h>
#include <string.h>

#include "branch.h"

enum { LATENCY_MS = 200, KEY_BYTES = 16 };

static gboolean on_connecting(GstElement *sink, GSocketAddress *address, const char *stream, struct video_branch *branch)
{
    (void)sink;
    (void)address;
    (void)stream;
    return g_atomic_int_get(&branch->readers) < branch->options->most_readers;
}

static void on_added(GstElement *sink, int fd, GSocketAddress *address, struct video_branch *branch)
{
    (void)sink;
    (void)fd;
    (void)address;
    g_atomic_int_inc(&branch->readers);
}

static void on_removed(GstElement *sink, int fd, GSocketAddress *address, struct video_branch *branch)
{
    (void)sink;
    (void)fd;
    (void)address;
    g_atomic_int_add(&branch->readers, -1);
}

static void prepare(struct video_branch *branch, GstElement *pipeline)
{
    const struct video_options *options = branch->options;
    bool six = strchr(options->listen, ':') != NULL;
    char *uri = g_strdup_printf("srt://%s%s%s:%d?mode=listener", six ? "[" : "", options->listen, six ? "]" : "", options->srt_port);
    GstElement *sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
    g_object_set(sink, "uri", uri, "latency", LATENCY_MS, "wait-for-connection", FALSE, NULL);
    if (options->password)
        g_object_set(sink, "passphrase", options->password, "pbkeylen", KEY_BYTES, NULL);
    g_signal_connect(sink, "caller-connecting", G_CALLBACK(on_connecting), branch);
    g_signal_connect(sink, "caller-added", G_CALLBACK(on_added), branch);
    g_signal_connect(sink, "caller-removed", G_CALLBACK(on_removed), branch);
    gst_object_unref(sink);
    g_free(uri);
}

void srt_init(struct video_branch *srt, const struct video_options *options, struct outputs *outputs)
{
    *srt = (struct video_branch){ .name = "SRT",
                                  .text = g_strdup("mpegtsmux alignment=7 ! srtsink name=sink"),
                                  .outputs = outputs,
                                  .prepare = prepare,
                                  .options = options };
}
