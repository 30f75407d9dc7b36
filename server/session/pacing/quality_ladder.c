/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps of quality and size. */
#include "session/pacing/quality_ladder.h"

#include "base/clock.h"

static const int64_t SLOW_NS = 80 * NS_PER_MS; /* a frame that takes the network longer is too large */
static const int64_t FAST_NS = 40 * NS_PER_MS; /* a better step that is expected to take less is tried */
static const int64_t FIRST_PATIENCE_NS = 1 * NS_PER_S, LAST_PATIENCE_NS = 30 * NS_PER_S;
static const int64_t LASTED_NS = 5 * NS_PER_S;    /* a step up that held for so long was right */
static const int64_t SETTLE_NS = 500 * NS_PER_MS; /* a step down shows in the lag only after some frames */
static const int64_t HARD_NS = 40 * NS_PER_MS;    /* decoding that takes longer cannot follow 25 frames a second */
static const int64_t EASY_NS = 20 * NS_PER_MS;
static const int64_t HARD_MADE_NS = 130 * NS_PER_MS; /* two are being made at once: fewer than 15 a second */
static const int64_t EASY_MADE_NS = 90 * NS_PER_MS;
static const int64_t HARD_FOR_NS = 500 * NS_PER_MS, EASY_FOR_NS = 3 * NS_PER_S;
static const double SHARE = 0.25;
static const double CROWD_BYTES = 30e6;     /* of one frame, to all who see it: what a loop sends in some tens of milliseconds */
enum { FEWEST = 3, NEARLY = 2 };            /* who share a step; how much worse one of them may be */
static const double BYTES_PER_PIXEL = 0.08; /* of the first step, before any was seen */

/* Bytes beside those of the first step: measured on the demo plant at 1920x1080. */
static const struct {
    struct rung rung;
    double bytes;
} steps[QUALITY_LADDER_STEPS] = {
    { { 78, 1 }, 1 },      { { 66, 1 }, 0.78 },   { { 54, 1 }, 0.64 },    { { 42, 1 }, 0.53 },    { { 42, 0.75 }, 0.35 },
    { { 42, 0.5 }, 0.19 }, { { 30, 0.5 }, 0.15 }, { { 30, 0.35 }, 0.09 }, { { 25, 0.25 }, 0.05 },
};
static const double sizes[QUALITY_LADDER_SIZES] = { 1, 0.75, 0.5, 0.35 };

void quality_ladder_init(struct quality_ladder *ladder)
{
    *ladder = (struct quality_ladder){ .step = QUALITY_LADDER_FIRST, .patience_ns = FIRST_PATIENCE_NS };
}

int quality_ladder_common(const struct quality_ladder *seen, const int counts[QUALITY_LADDER_STEPS])
{
    int all = 0, below = 0, step = 0;
    for (int i = 0; i < QUALITY_LADDER_STEPS; i++)
        all += counts[i];
    while (all >= FEWEST && 4 * (below += counts[step]) < 3 * all)
        step++;
    while (step < QUALITY_LADDER_STEPS - 1 && all * seen->unit_bytes * steps[step].bytes > CROWD_BYTES)
        step++;
    return all >= FEWEST ? step : -1;
}

int quality_ladder_step(const struct quality_ladder *ladder, int common)
{
    return common >= 0 && ladder->step <= common + NEARLY ? common : ladder->step;
}

struct rung quality_ladder_rung(const struct quality_ladder *ladder, int step)
{
    struct rung rung = steps[step].rung;
    if (sizes[ladder->size] < rung.scale)
        rung.scale = sizes[ladder->size];
    return rung;
}

double quality_ladder_bytes(const struct quality_ladder *ladder)
{
    return ladder->unit_bytes * steps[ladder->step].bytes;
}

/* Fewer pixels are the last resort: those who share a view then share no frame any more. */
static int patience_with(int step)
{
    return step < QUALITY_LADDER_STEPS - 1 && steps[step + 1].rung.scale < 1 ? 2 : 1;
}

/* The best step whose frames the network is expected to take in that time. */
static int best_within(const struct quality_ladder *ladder, const struct channel *channel, int64_t limit_ns)
{
    int step = 0;
    while (step < QUALITY_LADDER_STEPS - 1 &&
           channel_transfer_ns(channel, ladder->unit_bytes * steps[step].bytes) > limit_ns * patience_with(step))
        step++;
    return step;
}

void quality_ladder_begin(struct quality_ladder *ladder, const struct channel *channel, double pixels)
{
    ladder->unit_bytes = BYTES_PER_PIXEL * pixels;
    ladder->step = best_within(ladder, channel, SLOW_NS);
}

static void go_up(struct quality_ladder *ladder, int step, int64_t now_ns)
{
    ladder->step = step;
    ladder->up_ns = now_ns;
    ladder->good_since_ns = 0;
}

/* What went up and came down again soon is tried more rarely. */
static void go_down(struct quality_ladder *ladder, int step, int64_t now_ns)
{
    if (ladder->up_ns && now_ns - ladder->up_ns < LASTED_NS)
        ladder->patience_ns = ladder->patience_ns * 2 > LAST_PATIENCE_NS ? LAST_PATIENCE_NS : ladder->patience_ns * 2;
    else
        ladder->patience_ns = FIRST_PATIENCE_NS;
    ladder->step = step;
    ladder->down_ns = now_ns;
    ladder->good_since_ns = 0;
}

static void follow_network(struct quality_ladder *ladder, const struct channel *channel, int64_t now_ns)
{
    int down = best_within(ladder, channel, SLOW_NS), up = best_within(ladder, channel, FAST_NS);
    bool lags = channel->lag_ns > 2.0 * SLOW_NS * patience_with(ladder->step) && ladder->step < QUALITY_LADDER_STEPS - 1 &&
                now_ns - ladder->down_ns >= SETTLE_NS;
    if (down > ladder->step || lags) {
        go_down(ladder, down > ladder->step ? down : ladder->step + 1, now_ns);
    } else if (up >= ladder->step || channel->lag_ns > SLOW_NS) {
        ladder->good_since_ns = 0;
    } else if (!ladder->known) {
        go_up(ladder, up, now_ns); /* the first step was a guess */
    } else if (!ladder->good_since_ns) {
        ladder->good_since_ns = now_ns;
    } else if (now_ns - ladder->good_since_ns >= ladder->patience_ns) {
        go_up(ladder, up, now_ns);
    }
}

/* True: it has been so for that long. */
static bool lasts(int64_t *since_ns, bool now, int64_t limit_ns, int64_t now_ns)
{
    if (!now)
        *since_ns = 0;
    else if (!*since_ns)
        *since_ns = now_ns;
    return now && now_ns - *since_ns >= limit_ns;
}

/* Fewer pixels where a frame costs too much, more again where so many would cost little. */
static void follow_cost(struct quality_ladder *ladder, int64_t cost_ns, int64_t hard_ns, int64_t easy_ns, int64_t now_ns)
{
    double ratio = ladder->size > 0 ? sizes[ladder->size - 1] / sizes[ladder->size] : 1;
    bool hard = lasts(&ladder->bad_since_ns, cost_ns > hard_ns, HARD_FOR_NS, now_ns);
    bool easy = lasts(&ladder->easy_since_ns, (double)cost_ns * ratio * ratio < (double)easy_ns, EASY_FOR_NS, now_ns);
    if (hard && ladder->size < QUALITY_LADDER_SIZES - 1)
        ladder->size++;
    else if (easy && ladder->size > 0)
        ladder->size--;
    if (hard || easy)
        ladder->bad_since_ns = ladder->easy_since_ns = 0;
}

void quality_ladder_on_made(struct quality_ladder *ladder, int64_t made_ns, int64_t now_ns)
{
    follow_cost(ladder, made_ns, HARD_MADE_NS, EASY_MADE_NS, now_ns);
}

void quality_ladder_on_ack(struct quality_ladder *ladder, const struct channel *channel, int step, size_t bytes, int64_t now_ns)
{
    double unit = (double)bytes / steps[step].bytes;
    ladder->unit_bytes = ladder->known ? ladder->unit_bytes + SHARE * (unit - ladder->unit_bytes) : unit; /* before, it was a guess */
    if (channel->ns_per_byte > 0) {
        follow_network(ladder, channel, now_ns);
        ladder->known = true;
    }
    follow_cost(ladder, channel->decode_ns, HARD_NS, EASY_NS, now_ns);
}
