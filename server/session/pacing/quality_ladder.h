/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The quality ladder (adaptive bitrate): the quality of one session's previews. As bandwidth drops, first the JPEG or H.264
   quality is lowered, then the number of pixels; if that is not enough, the pacer sends fewer frames. Steps down are immediate.
   Steps up wait for a delay, which doubles if the last step up did not hold. Pure; the caller passes the time. Call only in the
   event loop. */
#ifndef SESSION_PACING_QUALITY_LADDER_H
#define SESSION_PACING_QUALITY_LADDER_H
#include "session/pacing/channel.h"

enum { QUALITY_LADDER_STEPS = 9, QUALITY_LADDER_FIRST = 3 /* index of the initial step, used until the client's bandwidth is
                                                             known */, QUALITY_LADDER_SIZES = 4 };

struct rung {
    int quality;
    double scale; /* factor by which width and height of the client's view are multiplied */
};

struct quality_ladder { /* chooses the quality and size of one client's frames; initialise with quality_ladder_init() */
    int step;           /* index of the quality step, 0: best; depends on the bandwidth */
    int size;           /* index of the picture size, 0: full; depends on the client's decoding time and the server's rendering time */
    double unit_bytes;  /* estimated size in bytes of a frame of the best quality (step 0), smoothed */
    bool reprojects;    /* true: the client reprojects its newest picture to the present camera, so fewer and better frames suffice */
    bool known;         /* true: at least one frame was acknowledged, so unit_bytes is measured */
    /* monotonic time since which a condition has held; 0: it does not hold now. good_since_ns: the network can carry a better
       step; easy_since_ns: client and server can handle a larger picture; bad_since_ns: decoding takes too long */
    int64_t good_since_ns, easy_since_ns, bad_since_ns;
    int64_t up_ns, down_ns; /* up_ns: monotonic time of the ladder's last step up; down_ns: of its last step down */
    /* nanoseconds for which the conditions for a step up must hold before the ladder takes the step; doubles if the last step
       up did not hold */
    int64_t patience_ns;
};

/* Initialises the ladder at QUALITY_LADDER_FIRST. */
void quality_ladder_init(struct quality_ladder *ladder);
/* Chooses the quality step of the client's first frame, which has `pixels` pixels, from what its channel (round trip,
   bandwidth) has shown so far. */
void quality_ladder_begin(struct quality_ladder *ladder, const struct channel *channel, double pixels);
/* Returns the encoding quality and the scale of pictures at a quality step, for the picture size that the ladder has chosen. */
struct rung quality_ladder_rung(const struct quality_ladder *ladder, int step);
/* Returns the common quality step of all viewers of one view, with which each frame is drawn and encoded once for all. The step
   is the best one that at least three quarters of the viewers can receive, or a worse one if sending frames of that quality to
   all would occupy the event loop. counts: number of viewers whose own step is each step. seen: ladder of the session whose
   view is shared; it knows the size of frames. Returns a negative number if there are too few viewers to share a step. */
int quality_ladder_common(const struct quality_ladder *seen, const int counts[QUALITY_LADDER_STEPS]);
/* Returns the quality step for this client: `common`, the step of all viewers of its view, or the client's own step if that is
   much worse. common negative: there is no common step, so the client's own step. */
int quality_ladder_step(const struct quality_ladder *ladder, int common);
/* Records that the client acknowledged a preview of that quality step and size in bytes, and adjusts the ladder's step. */
void quality_ladder_on_ack(struct quality_ladder *ladder, const struct channel *channel, int step, size_t bytes, int64_t now_ns);
/* Records how long the server took to make previews, from request to encoded frame, and adjusts the picture size. Used for the
   ladder of a picture over many displays: it has more pixels than any client's picture, so making it may be the bottleneck. */
void quality_ladder_on_made(struct quality_ladder *ladder, int64_t made_ns, int64_t now_ns);
/* Returns the expected size in bytes of a preview at the ladder's own step; 0: not known. */
double quality_ladder_bytes(const struct quality_ladder *ladder);

#endif
