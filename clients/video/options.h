/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The command line of plantcast-video. */
#ifndef VIDEO_OPTIONS_H
#define VIDEO_OPTIONS_H
#include <glib.h>
#include <stdbool.h>

#include "render/view.h"

enum { OPTIONS_MOST_READERS = 512 };

struct video_options {
    char *url;             /* URL of the daemon, ends with a slash */
    char *view, *query;    /* view: id of a saved view; query: parameters as /snapshot.png takes them. If both are NULL, the video shows
                              the whole plant */
    char *language;        /* language of text cards, legend and the strip below the picture (title and clock): en, ko or de */
    enum language words;   /* the same language */
    char *token, *ca_path, *token_path; /* NULL: not given */
    char *listen;                       /* address on which all outputs listen */
    int width_px, height_px, fps, kbps, every_ms;
    int rtsp_port, http_port, srt_port; /* port 0: off; RTSP and SRT send the video, HTTP serves /metrics */
    char *user, *password;              /* name and password that viewers of the RTSP stream must give; NULL: no login */
    int most_readers;                   /* limit per output */
    bool time_code;
};

/* Parses the command line and reads the files that it names. Returns -1 to continue, or the exit code with errors printed. The caller
   finishes *options in both cases. Call it before any thread starts. */
int options_read(struct video_options *options, int *argc, char ***argv);
void options_finish(struct video_options *options);

#endif
