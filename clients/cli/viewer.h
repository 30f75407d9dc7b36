/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A client without a screen: connects, moves its camera, decodes every frame before it acknowledges it, and keeps the times.
   Thread: one per viewer, after viewer_create. */
#ifndef CLI_VIEWER_H
#define CLI_VIEWER_H
#include <stddef.h>
#include <stdint.h>

#include "daemon.h"

enum motion { MOTION_STILL, MOTION_ORBIT };

enum { VIEWER_SETTLES_S = 3 };

struct viewer_params {
    const struct daemon_url *url;
    int width_px, height_px;
    const char *codec; /* "jpeg", "h264" */
    enum motion motion;
    double seconds;
    double start_deg; /* of the orbit */
};

struct samples { /* milliseconds */
    double *at;
    size_t count, capacity;
};

enum viewer_stage { STAGE_WAIT, STAGE_FIELD, STAGE_RENDER, STAGE_ENCODE, STAGE_DECODE, STAGE_COUNT };

struct viewer_result {
    int frames, still_frames, errors;
    int given_up; /* frames that the server did not send to their end */
    int64_t text_bytes, steady_bytes; /* steady: of all messages, once VIEWER_SETTLES_S have gone by since the first frame */
    int64_t bytes, first_ns, last_ns; /* of frames; monotonic */
    struct samples input;             /* from sending a camera to its frame decoded */
    struct samples first;             /* from connecting to the first frame decoded: one */
    struct samples stages[STAGE_COUNT];
    char failure[200]; /* "": went well */
};

struct viewer;
struct viewer *viewer_create(const struct viewer_params *params); /* NULL: out of memory */
void viewer_run(struct viewer *viewer);                           /* until params.seconds after the first frame, or failure */
const struct viewer_result *viewer_result(const struct viewer *viewer);
void viewer_destroy(struct viewer **viewer);

#endif
