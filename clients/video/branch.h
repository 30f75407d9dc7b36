/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An output that is a pipeline of its own: it fails alone, and is begun anew. Thread: that of the default main context. */
#ifndef VIDEO_BRANCH_H
#define VIDEO_BRANCH_H
#include "options.h"
#include "outputs.h"

struct branch {
    const char *name;
    char *text; /* of the pipeline behind OUTPUTS_SOURCE */
    struct outputs *outputs;
    void (*prepare)(struct branch *branch, GstElement *pipeline); /* before it plays */
    void (*clear)(struct branch *branch);                         /* after it has ended, however; NULL: nothing to be done */
    const struct options *options;
    GstElement *pipeline; /* NULL: it has failed, and waits */
    gint64 again_us;
    gint readers; /* atomic */
};

/* Begins it. Takes branch->text. Returns false with the reason printed. */
bool branch_begin(struct branch *branch);
/* Looks whether it has failed, and begins it anew some seconds later; call it once a second. */
void branch_look(struct branch *branch);
void branch_end(struct branch *branch);

/* Writes segments and playlist of HLS into options->hls_path, deleting those of before. */
void hls_init(struct branch *hls, const struct options *options, struct outputs *outputs);
/* Listens for callers by SRT. */
void srt_init(struct branch *srt, const struct options *options, struct outputs *outputs);

#endif
