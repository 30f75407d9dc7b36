/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How good the moving pictures of one session are: less quality first, then fewer pixels; what is still too much makes them rarer, which
   is the pacer's. Down at once, up after a while, and a longer while where it did not last. Pure; time is handed in. */
#ifndef SESSION_QUALITY_LADDER_H
#define SESSION_QUALITY_LADDER_H
#include "session/channel.h"

enum { QUALITY_LADDER_STEPS = 9, QUALITY_LADDER_FIRST = 3 /* where a client starts of whom nothing is known */, QUALITY_LADDER_SIZES = 4 };

struct rung {
    int quality;
    double scale; /* of width and height */
};

struct quality_ladder {                                 /* quality_ladder_init */
    int step;                                           /* 0: best; by what the network takes */
    int size;                                           /* 0: full; by how long the client decodes */
    double unit_bytes;                                  /* of a frame of step 0, as far as is known; smoothed */
    bool known;                                         /* something was acknowledged */
    int64_t good_since_ns, easy_since_ns, bad_since_ns; /* a better step would do; likewise size; decoding takes too long. 0: not now */
    int64_t up_ns, down_ns;                             /* when it last went so */
    int64_t patience_ns;
};

void quality_ladder_init(struct quality_ladder *ladder);
/* Before the first picture, of so many pixels: by what is known of the network already. */
void quality_ladder_begin(struct quality_ladder *ladder, const struct channel *channel, double pixels);
struct rung quality_ladder_rung(const struct quality_ladder *ladder, int step); /* at that step, instead of its own */
/* Those who see the same take one step together, or each picture would be drawn and encoded for every one of them: the worst that
   three quarters of them need, and none whose pictures would keep the loop from anything else while they go to all of them. counts: of
   them, by step; seen: of the one whose view it is. Negative: too few to matter. */
int quality_ladder_common(const struct quality_ladder *seen, const int counts[QUALITY_LADDER_STEPS]);
/* The step to take: the common one, unless the own one is much worse. common negative: the own one. */
int quality_ladder_step(const struct quality_ladder *ladder, int common);
/* A moving picture of that step was acknowledged. */
void quality_ladder_on_ack(struct quality_ladder *ladder, const struct channel *channel, int step, size_t bytes, int64_t now_ns);
/* What a moving picture of its own step is expected to have; 0: not known. */
double quality_ladder_bytes(const struct quality_ladder *ladder);

#endif
