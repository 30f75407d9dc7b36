/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One output of the video, such as SRT, with its own GStreamer pipeline. If the pipeline fails, it is restarted; the other
   outputs continue meanwhile. Call only in the thread of GLib's default main context. */
#ifndef VIDEO_BRANCH_H
#define VIDEO_BRANCH_H
#include "options.h"
#include "outputs.h"

struct video_branch {
    const char *name;
    char *text; /* pipeline description that follows OUTPUTS_SOURCE */
    struct outputs *outputs;
    /* callback that sets up the new pipeline before it starts to play */
    void (*prepare)(struct video_branch *branch, GstElement *pipeline);
    const struct video_options *options;
    GstElement *pipeline; /* pipeline of this output; NULL: it has failed and is restarted at again_us */
    gint64 again_us;
    gint readers; /* number of connected readers; atomic */
};

/* Starts the GStreamer pipeline that branch->text describes; takes ownership of that text. Returns false with the reason printed. */
bool branch_begin(struct video_branch *branch);
/* Restarts the pipeline 5 s after it has failed; call it once a second, so that a failure is noticed. */
void branch_look(struct video_branch *branch);
void branch_end(struct video_branch *branch);

/* Prepares the pipeline that sends the video to SRT clients, without starting it. */
void srt_init(struct video_branch *srt, const struct video_options *options, struct outputs *outputs);

#endif
