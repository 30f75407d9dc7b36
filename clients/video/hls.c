/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HLS: segments of a key frame's distance, and their playlist. */
#include <glib/gstdio.h>

#include "branch.h"

enum { SEGMENT_S = 2, LISTED = 5, KEPT = 10 };

static bool is_ours(const char *name)
{
    return !g_strcmp0(name, "index.m3u8") || (g_str_has_prefix(name, "plantcast-") && g_str_has_suffix(name, ".ts"));
}

/* What nobody goes on with is not to be seen: a player that has the playlist would show the last picture. */
static void delete_files(struct branch *branch)
{
    GDir *dir = g_dir_open(branch->options->hls_path, 0, NULL);
    const char *name;
    while (dir && (name = g_dir_read_name(dir)) != NULL) {
        char *path = is_ours(name) ? g_build_filename(branch->options->hls_path, name, NULL) : NULL;
        if (path)
            g_unlink(path);
        g_free(path);
    }
    g_clear_pointer(&dir, g_dir_close);
}

/* Names of segments are of this run alone: what somebody keeps of another is not taken for them. */
static void prepare(struct branch *branch, GstElement *pipeline)
{
    const char *folder = branch->options->hls_path;
    char *name = g_strdup_printf("plantcast-%" G_GINT64_FORMAT "-%%05d.ts", g_get_real_time() / G_USEC_PER_SEC);
    char *segments = g_build_filename(folder, name, NULL), *playlist = g_build_filename(folder, "index.m3u8", NULL);
    GstElement *sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
    delete_files(branch);
    g_object_set(sink, "location", segments, "playlist-location", playlist, "target-duration", SEGMENT_S, "playlist-length", LISTED,
                 "max-files", KEPT, "send-keyframe-requests", FALSE, NULL);
    gst_object_unref(sink);
    g_free(playlist);
    g_free(segments);
    g_free(name);
}

void hls_init(struct branch *hls, const struct options *options, struct outputs *outputs)
{
    *hls = (struct branch){ .name = "HLS",
                            .text = g_strdup("hlssink2 name=sink"),
                            .outputs = outputs,
                            .prepare = prepare,
                            .clear = delete_files,
                            .options = options };
}
