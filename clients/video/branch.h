/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An output that is a pipeline of its own: if it fails, the others go on, and it starts again. Thread: that of the default main context. */
#ifndef VIDEO_BRANCH_H
#define VIDEO_BRANCH_H
#include "options.h"
#include "outputs.h"

struct video_branch {
    const char *name;
    char *text; /* of the pipeline behind OUTPUTS_SOURCE */
    struct outputs *outputs;
    void (*prepare)(struct video_branch *branch, GstElement *pipeline); /* before it plays */
    const struct video_options *options;
    GstElement *pipeline; /* NULL: the pipeline failed, and is to start again at again_us */
    gint64 again_us;
    gint readers; /* atomic */
};

/* Starts the pipeline. Takes branch->text. Returns false with the reason printed. */
bool branch_begin(struct video_branch *branch);
/* Starts the pipeline again some seconds after it failed; call it once a second. */
void branch_look(struct video_branch *branch);
void branch_end(struct video_branch *branch);

/* Listens for callers by SRT. */
void srt_init(struct video_branch *srt, const struct video_options *options, struct outputs *outputs);

#endif
