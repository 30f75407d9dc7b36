/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The quality ladder (adaptive bitrate): how good the previews of one session are. First JPEG or H.264 quality goes down, then the number
   of pixels; if that is not enough, the pacer sends fewer frames. Steps down are taken at once, steps up after a while, and after a longer
   one if the last did not hold. Pure; time is handed in. Thread: the loop. */
#ifndef SESSION_PACING_QUALITY_LADDER_H
#define SESSION_PACING_QUALITY_LADDER_H
#include "session/pacing/channel.h"

enum { QUALITY_LADDER_STEPS = 9, QUALITY_LADDER_FIRST = 3 /* where an unknown client starts */, QUALITY_LADDER_SIZES = 4 };

struct rung {
    int quality;
    double scale; /* of width and height */
};

struct quality_ladder { /* quality_ladder_init */
    int step;           /* 0: best; set by the bandwidth */
    int size;           /* 0: full; set by how long the client decodes, or the server takes */
    double unit_bytes;  /* size of a frame at step 0, estimated and smoothed */
    bool known;         /* a frame was acknowledged */
    int64_t good_since_ns, easy_since_ns,
        bad_since_ns;       /* since when a better step would do, a better size would, decoding takes too long; 0: not now */
    int64_t up_ns, down_ns; /* when it last went up, down */
    int64_t patience_ns;
};

/* Starts at QUALITY_LADDER_FIRST. */
void quality_ladder_init(struct quality_ladder *ladder);
/* Chooses the step of the first frame, of so many pixels, by what is known of the network already. */
void quality_ladder_begin(struct quality_ladder *ladder, const struct channel *channel, double pixels);
/* Returns quality and scale at that step, and at the ladder's own size. */
struct rung quality_ladder_rung(const struct quality_ladder *ladder, int step);
/* Returns the step that all who see one view take together, so that its frames are drawn and encoded once: the worst that three quarters
   of them need, and none whose frames would occupy the loop while they are sent to all. counts: viewers by step; seen: the ladder of the
   session whose view it is. Negative: too few viewers to matter. */
int quality_ladder_common(const struct quality_ladder *seen, const int counts[QUALITY_LADDER_STEPS]);
/* Returns the step to take: the common one, unless this client's own is much worse; its own if common is negative. */
int quality_ladder_step(const struct quality_ladder *ladder, int common);
/* Notes that a preview of that step and size in bytes was acknowledged, and moves the step. */
void quality_ladder_on_ack(struct quality_ladder *ladder, const struct channel *channel, int step, size_t bytes, int64_t now_ns);
/* Notes how long the server took to make previews from when they were asked for, and moves the size. For ladders that no client moves: of
   a picture over many displays, which has more pixels than that of one. */
void quality_ladder_on_made(struct quality_ladder *ladder, int64_t made_ns, int64_t now_ns);
/* Returns the expected size of a preview at the ladder's own step, in bytes; 0: not known. */
double quality_ladder_bytes(const struct quality_ladder *ladder);

#endif
