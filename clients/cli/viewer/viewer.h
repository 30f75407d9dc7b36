/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A viewer without a screen: connects, moves its camera, decodes every frame before it acknowledges it, and measures latencies. Thread: the
   one that services its context (viewer_threads.h). */
#ifndef CLI_VIEWER_VIEWER_H
#define CLI_VIEWER_VIEWER_H
#include <libwebsockets.h>
#include <pthread.h>
#include <stddef.h>
#include <stdint.h>

#include "clients/link/daemon.h"

enum motion { MOTION_STILL, MOTION_ORBIT, MOTION_RANDOM, MOTION_COUNT };

enum { VIEWER_SETTLES_S = 3, LEAD_CAMERAS = 256 };

/* State that a leading viewer shares with its followers. */
struct leader {
    pthread_mutex_t lock;
    /* --- below: under lock */
    uint64_t session; /* session of the leader; 0: not connected yet */
    struct {
        double eye[3];
        int64_t sent_ns;
    } cameras[LEAD_CAMERAS]; /* latest cameras, by sequence number modulo LEAD_CAMERAS */
    uint32_t newest;
};

struct viewer_params {
    const struct daemon_url *url;
    int width_px, height_px;
    const char *codec; /* "jpeg", "h264" */
    enum motion motion;
    double seconds, hz;  /* hz: camera updates per second */
    double start_deg;    /* start angle of the orbit; in a still view, the angle from the plant's initial camera (0: that camera) */
    unsigned seed;       /* seed of random motion */
    bool blind;          /* whether to acknowledge without decoding */
    const char *signs;   /* frames to request signed: `refined`, `all`; NULL: none */
    const char *folder;  /* folder for signed frames; NULL: do not save */
    int number;          /* index of this viewer, part of the names of saved files */
    bool stalls;         /* true: the viewer stops reading from the socket after the first frame, like a client that hangs */
    struct leader *lead; /* shared state of leader and followers; NULL: neither leads nor follows */
    bool follows;        /* true: this viewer follows; false: it leads */
};

struct latency_samples { /* milliseconds */
    double *at;
    size_t count, capacity;
};

enum viewer_stage { STAGE_WAIT, STAGE_FIELD, STAGE_RENDER, STAGE_ENCODE, STAGE_NETWORK, STAGE_DECODE, STAGE_COUNT };

struct viewer_result {
    int frames, still_frames, errors, signed_frames;
    int given_up;                     /* frames that the server aborted */
    int64_t text_bytes, steady_bytes; /* text_bytes: of text messages; steady_bytes: of all messages except pongs, from VIEWER_SETTLES_S
                                         after the first frame */
    int64_t bytes, first_ns, last_ns; /* frame bytes; time of the first and last frame, monotonic */
    struct latency_samples input;     /* latency from sending a camera until its frame is decoded */
    struct latency_samples sensor;    /* latency from a changed reading in the server until its frame is decoded */
    struct latency_samples behind;    /* in a follower: latency from the leader sending a camera until its frame is decoded here */
    struct latency_samples first;     /* time from connecting until the first frame is decoded; one sample */
    struct latency_samples stages[STAGE_COUNT];
    char failure[200]; /* reason of failure; "": none */
};

struct viewer;
/* Creates a viewer that is not connected. NULL: out of memory. The caller destroys it. */
struct viewer *viewer_create(const struct viewer_params *params);
/* Connects. The context's thread then runs the viewer until params.seconds after the first frame, or until it fails. */
void viewer_connect(struct viewer *viewer, struct lws_context *context);
/* Returns whether the viewer has finished. */
bool viewer_done(const struct viewer *viewer);
/* Returns the monotonic time at which the viewer's timer fires, if the viewer waits for nothing but that timer and its socket (*fd; -1:
   none); else 0. */
int64_t viewer_rests_until_ns(const struct viewer *viewer, int *fd);
/* Returns the viewer's measurements, which belong to the viewer. */
const struct viewer_result *viewer_result(const struct viewer *viewer);
/* Frees the viewer. Destroy its context first. &NULL is fine; leaves NULL. */
void viewer_destroy(struct viewer **viewer);

extern const struct lws_protocols viewer_protocols[];
/* Sets what the viewer needs in the creation info of its libwebsockets context. */
void viewer_prepare_context(const struct viewer *viewer, struct lws_context_creation_info *info);

#endif
