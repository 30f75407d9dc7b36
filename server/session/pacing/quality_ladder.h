/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The quality ladder (adaptive bitrate): the quality of one session's previews. As bandwidth drops, first the JPEG or H.264
   quality is lowered, then the number of pixels; if that is not enough, the pacer sends fewer frames. Steps down are immediate.
   Steps up wait for a delay, which doubles if the last step up did not hold. Pure; the caller passes the time. Call only in the
   event loop. */
#ifndef SESSION_PACING_QUALITY_LADDER_H
#define SESSION_PACING_QUALITY_LADDER_H
#include "session/pacing/channel.h"
#include "session/pacing/picture_size.h"

/* QUALITY_LADDER_FIRST: index of the initial step, used until the client's bandwidth is known */
enum { QUALITY_LADDER_STEPS = 9, QUALITY_LADDER_FIRST = 3 };

struct rung {
    int quality;
    double scale; /* factor by which width and height of the client's view are multiplied */
};

struct quality_ladder { /* chooses the quality and size of one client's frames; initialise with quality_ladder_init() */
    int step;           /* index of the quality step, 0: best; depends on the bandwidth */
    /* Picture sizes, of which the smaller one counts. decoded: depends on the client's decoding time; made: on the time that the
       server takes for one picture of this client while it serves the others, too. */
    struct picture_size decoded, made;
    double made_ns;     /* time that the server takes for one picture, smoothed */
    int64_t made_at_ns; /* monotonic time when made_ns was measured last; 0: never */
    double unit_bytes;  /* estimated size in bytes of a frame of the best quality (step 0) and of full size, smoothed */
    bool reprojects;    /* true: the client reprojects its newest picture to the present camera, so fewer and better frames suffice */
    bool known;         /* true: at least one frame was acknowledged, so unit_bytes is measured */
    int64_t good_since_ns;  /* monotonic time since which the network could carry a better step; 0: it cannot now */
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
/* Records that the client acknowledged a preview of that quality step and size in bytes, and adjusts the ladder's step. scale: as in
   struct pacer_note. */
void quality_ladder_on_ack(struct quality_ladder *ladder, const struct channel *channel, int step, double scale, size_t bytes,
                           int64_t now_ns);
/* Records that the server took took_ns to make a preview, and adjusts the picture size. This is the time since it began to owe
   the client a preview: since the client's last one, or since the request if that came later. A preview after a rest does not make
   pictures smaller, because what takes long may be the change of the field for which it was requested. */
void quality_ladder_on_made(struct quality_ladder *ladder, int64_t took_ns, int64_t now_ns);
/* Returns the expected size in bytes of a preview at the ladder's own step; 0: not known. */
double quality_ladder_bytes(const struct quality_ladder *ladder);

#endif
