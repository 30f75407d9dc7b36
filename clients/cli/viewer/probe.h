/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast probe`: what it is to do, and its report. */
#ifndef CLI_VIEWER_PROBE_H
#define CLI_VIEWER_PROBE_H
#include "viewer.h"

struct probe {
    struct daemon_url url;
    const char *url_text, *codec, *signs, *folder;
    int sessions, stalled, width_px, height_px;
    int watching; /* the first of the sessions: those that do not stall */
    double seconds, hz;
    enum motion motion;
    bool as_json, blind, follow, spread;
    struct viewer **viewers;
    struct leader lead;
};

extern const char *const probe_motions[MOTION_COUNT];

/* Prints the results of viewers that have ended, as a table or JSON. Returns false if something failed or no frame came, with the reason
   printed. */
bool probe_report(const struct probe *probe);

#endif
