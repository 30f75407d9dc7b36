/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Options and report of `plantcast probe`. */
#ifndef CLI_VIEWER_PROBE_H
#define CLI_VIEWER_PROBE_H
#include "viewer.h"

struct probe {
    struct daemon_url url;
    const char *url_text, *codec, *signs, *folder;
    int sessions, stalled, width_px, height_px;
    /* number of viewers that read all frames, first in `viewers`; the others stop reading after the first frame, like clients that hang */
    int watching;
    double seconds, hz;
    enum motion motion;
    bool as_json, blind, follow, spread;
    struct viewer **viewers;
    struct leader lead;
};

extern const char *const probe_motions[MOTION_COUNT];

/* Prints the measurements of finished viewers, as a table or JSON. Returns false if a viewer failed or no frame arrived, with the reason
   printed. */
bool probe_report(const struct probe *probe);

#endif
