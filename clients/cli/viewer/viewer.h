/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A viewer without a screen: connects, moves its camera, decodes every frame before it acknowledges the frame, and measures latencies.
   Call only in the thread that services its libwebsockets context (viewer_threads.h). */
#ifndef CLI_VIEWER_VIEWER_H
#define CLI_VIEWER_VIEWER_H
#include <libwebsockets.h>
#include <pthread.h>
#include <stddef.h>
#include <stdint.h>

#include "clients/link/daemon.h"

enum motion { MOTION_STILL, MOTION_ORBIT, MOTION_RANDOM, MOTION_COUNT };

enum { VIEWER_SETTLES_S = 3, LEAD_CAMERAS = 256 };

/* State that one viewer, the leader, shares with the viewers that follow its view, the followers. */
struct leader {
    pthread_mutex_t lock;
    /* --- below: under lock */
    uint64_t session; /* session id of the leading viewer, which followers ask the daemon to follow; 0: not connected yet */
    /* newest cameras that the leading viewer sent, by sequence number modulo LEAD_CAMERAS; followers measure their delay with them */
    struct {
        double eye[3];
        int64_t sent_ns;
    } cameras[LEAD_CAMERAS];
    uint32_t newest;
};

struct viewer_params {
    const struct daemon_url *url;
    int width_px, height_px;
    const char *codec; /* "jpeg", "h264" */
    enum motion motion;
    double seconds, hz; /* hz: camera updates per second */
    double start_deg;   /* start angle of the camera's orbit in degrees; in a still view, rotation from the plant's initial camera (0: that
                            camera) */
    unsigned seed;      /* seed of random motion */
    bool blind;         /* true: the viewer acknowledges frames without decoding them */
    const char *signs;  /* which frames the daemon is asked to sign: `refined` (frames in final quality), `all`; NULL: none */
    const char *folder; /* folder to save signed frames in; NULL: they are not saved */
    int number;         /* index of this viewer, used in names of saved files */
    bool stalls;        /* true: the viewer stops reading its socket after the first frame, like a client that hangs */
    /* state shared by the leader and its followers; NULL: this viewer neither leads nor follows */
    struct leader *lead;
    bool follows; /* if `lead` is set: true: this viewer follows the leader's view; false: it is the leader */
};

struct latency_samples { /* milliseconds */
    double *at;
    size_t count, capacity;
};

enum viewer_stage { STAGE_WAIT, STAGE_FIELD, STAGE_RENDER, STAGE_ENCODE, STAGE_NETWORK, STAGE_DECODE, STAGE_COUNT };

struct viewer_result {
    int frames, still_frames, errors, signed_frames;
    int given_up;                     /* frames that the server aborted */
    int64_t text_bytes, steady_bytes; /* text_bytes: bytes received in text messages; steady_bytes: bytes received in all messages
                                         but pongs, counted from VIEWER_SETTLES_S after the first frame */
    int64_t bytes, first_ns, last_ns; /* bytes: total size of all frames; first_ns, last_ns: monotonic times of the first and the
                                         last frame */
    struct latency_samples input;     /* latencies from sending a camera to decoding a frame with it */
    struct latency_samples sensor;    /* latencies from a reading's change in the server to decoding a frame that shows it */
    /* only of a follower: latencies from the leader sending a camera to this viewer decoding a frame with it */
    struct latency_samples behind;
    struct latency_samples first; /* a single sample: time from connecting until the first frame is decoded */
    struct latency_samples stages[STAGE_COUNT];
    char failure[200]; /* why the viewer failed; "": it has not */
};

struct viewer;
/* Creates a viewer that is not connected. The caller destroys it. NULL: out of memory. */
struct viewer *viewer_create(const struct viewer_params *params);
/* Connects the viewer. The thread of `context` then runs it until params.seconds after the first frame, or until it fails. */
void viewer_connect(struct viewer *viewer, struct lws_context *context);
/* Returns true if the viewer has finished or failed. */
bool viewer_done(const struct viewer *viewer);
/* Returns the monotonic time until which a thread may sleep unless *fd, the viewer's socket (-1: none), becomes readable
   earlier. 0: do not sleep, because the viewer has something to do now, such as sending. */
int64_t viewer_rests_until_ns(const struct viewer *viewer, int *fd);
/* Returns the viewer's measurements, which belong to the viewer. */
const struct viewer_result *viewer_result(const struct viewer *viewer);
/* Frees the viewer. Destroy its libwebsockets context first. &NULL is fine; sets *viewer to NULL. */
void viewer_destroy(struct viewer **viewer);

extern const struct lws_protocols viewer_protocols[];
/* Sets the options that this viewer's connection needs in the creation info of a libwebsockets context. */
void viewer_prepare_context(const struct viewer *viewer, struct lws_context_creation_info *info);

#endif
