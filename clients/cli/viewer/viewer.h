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

/* What followers know of the one they follow. */
struct leader {
    pthread_mutex_t lock;
    /* --- below: under lock */
    uint64_t session; /* 0: not connected yet */
    struct {
        double eye[3];
        int64_t sent_ns;
    } cameras[LEAD_CAMERAS]; /* the newest, by number */
    uint32_t newest;
};

struct viewer_params {
    const struct daemon_url *url;
    int width_px, height_px;
    const char *codec; /* "jpeg", "h264" */
    enum motion motion;
    double seconds, hz;  /* hz: cameras in a second */
    double start_deg;    /* of the orbit; of the view, where it stands still and that is not 0 */
    unsigned seed;       /* of random motion */
    bool blind;          /* acknowledges without decoding */
    const char *signs;   /* which frames are to come signed: `refined`, `all`; NULL: none */
    const char *folder;  /* where signed frames are saved; NULL: nowhere */
    int number;          /* of the viewer, in their names */
    bool stalls;         /* reads nothing after the first frame */
    struct leader *lead; /* NULL: follows nobody and leads nobody */
    bool follows;        /* else it leads */
};

struct latency_samples { /* milliseconds */
    double *at;
    size_t count, capacity;
};

enum viewer_stage { STAGE_WAIT, STAGE_FIELD, STAGE_RENDER, STAGE_ENCODE, STAGE_NETWORK, STAGE_DECODE, STAGE_COUNT };

struct viewer_result {
    int frames, still_frames, errors, signed_frames;
    int given_up;                     /* frames that the server did not send to their end */
    int64_t text_bytes, steady_bytes; /* steady: of all messages but pongs, once VIEWER_SETTLES_S have gone by since the first frame */
    int64_t bytes, first_ns, last_ns; /* of frames; monotonic */
    struct latency_samples input;     /* from sending a camera to its frame decoded */
    struct latency_samples sensor;    /* from a reading that changed, in the server, to its frame decoded */
    struct latency_samples behind;    /* in a follower, from its leader's sending a camera to its frame decoded */
    struct latency_samples first;     /* from connecting to the first frame decoded: one */
    struct latency_samples stages[STAGE_COUNT];
    char failure[200]; /* "": went well */
};

struct viewer;
/* Creates a viewer that is not connected. NULL: out of memory. The caller destroys it. */
struct viewer *viewer_create(const struct viewer_params *params);
/* Connects. From then on the context's thread drives it, until params.seconds after the first frame or until it fails. */
void viewer_connect(struct viewer *viewer, struct lws_context *context);
/* Returns whether it has ended. */
bool viewer_done(const struct viewer *viewer);
/* Returns when its timer fires next, monotonic, if until then it only waits for what its socket brings (*fd; -1: for nothing); else 0. */
int64_t viewer_rests_until_ns(const struct viewer *viewer, int *fd);
/* Returns what it measured. Belongs to the viewer. */
const struct viewer_result *viewer_result(const struct viewer *viewer);
/* Frees the viewer; after its context. &NULL is fine; leaves NULL. */
void viewer_destroy(struct viewer **viewer);

extern const struct lws_protocols viewer_protocols[];
/* Sets what the viewer needs in the parameters of its libwebsockets context. */
void viewer_prepare_context(const struct viewer *viewer, struct lws_context_creation_info *info);

#endif
