/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The command line of plantcast-video. */
#ifndef VIDEO_OPTIONS_H
#define VIDEO_OPTIONS_H
#include <glib.h>
#include <stdbool.h>

enum { OPTIONS_MOST_READERS = 512 };

struct video_options {
    char *url;             /* of the daemon, with a slash at its end */
    char *view, *query;    /* id of a view with a name; or names and values as /snapshot.png takes them; both NULL: the whole plant */
    char *language;        /* of cards, strip and legend: en, ko or de */
    char *token, *ca_path, *token_path; /* NULL: none */
    char *listen;                       /* address of all outputs */
    int width_px, height_px, fps, kbps, every_ms;
    int rtsp_port, http_port, srt_port; /* 0: off */
    char *user, *password;              /* of those who watch; NULL: nobody is asked */
    int most_readers;                   /* of each output */
    bool time_code;
};

/* Reads the command line and the files that it names. Returns -1, or the exit code with everything said. The caller finishes the options
   in either case. Before any thread starts. */
int options_read(struct video_options *options, int *argc, char ***argv);
void options_finish(struct video_options *options);

#endif
