/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses the encoding quality and the picture size of one client's previews from the client's bandwidth and speed, and from the
   server's speed. */
#include "session/pacing/quality_ladder.h"

#include <math.h>

#include "base/clock.h"

/* transfer time of a frame, in nanoseconds, above which the ladder takes a step down (to lower quality or smaller pictures) */
static const int64_t SLOW_NS = 80 * NS_PER_MS;
/* expected transfer time of a frame at a better step, in nanoseconds, below which the ladder steps up to it */
static const int64_t FAST_NS = 40 * NS_PER_MS;
static const int64_t MIN_UP_DELAY_NS = 1 * NS_PER_S, MAX_UP_DELAY_NS = 30 * NS_PER_S;
static const int64_t LASTED_NS = 5 * NS_PER_S; /* nanoseconds without a step down after which the last step up counts as successful */
/* minimum time in nanoseconds between two steps down, because a step reduces the measured lag only some frames later */
static const int64_t SETTLE_NS = 500 * NS_PER_MS;
/* decoding time of a frame, in nanoseconds, above which the client cannot keep up with 25 frames a second */
static const int64_t SLOW_DECODE_NS = 40 * NS_PER_MS;
static const int64_t FAST_DECODE_NS = 20 * NS_PER_MS;
/* Time in nanoseconds that the server takes for a client's picture, above which pictures get smaller: fewer than 10.5 a second. A
   client that reprojects may get fewer by REPROJECTED_SLACK, 8 a second. */
static const int64_t SLOW_MADE_NS = 95 * NS_PER_MS, FAST_MADE_NS = 86 * NS_PER_MS;
static const double REPROJECTED_SLACK = 1.3;
/* share of the server's work on a preview that does not depend on its size; measured on the demo plant in 1920x1080 and less */
static const double MADE_FIXED = 0.25;
enum { MOST_MADE = 3 }; /* a picture that took longer than this many times SLOW_MADE_NS counts as such: it waited for one long step */
/* Nanoseconds without a preview: after REST_NS, the time since which pictures have been slow is forgotten; after IDLE_NS, what was
   measured. */
static const int64_t REST_NS = 200 * NS_PER_MS, IDLE_NS = 2 * NS_PER_S;
static const double SAMPLE_WEIGHT = 0.25;
/* limit on the total bytes of one frame's copies for all viewers of a view; the event loop needs some tens of milliseconds to
   send this many */
static const double CROWD_BYTES = 30e6;
/* MIN_VIEWERS: minimum number of viewers of a view that get a common step; MAX_STEPS_WORSE: a viewer whose own step is worse
   than the common one by more than this uses its own */
enum { MIN_VIEWERS = 3, MAX_STEPS_WORSE = 2 };
static const double BYTES_PER_PIXEL = 0.08; /* expected bytes per pixel of a frame at step 0, before any frame was sent */

/* Quality, scale and relative frame size of each step; sizes relative to step 0, measured on the demo plant at 1920x1080. */
static const struct {
    struct rung rung;
    double bytes;
} steps[QUALITY_LADDER_STEPS] = {
    { { 78, 1 }, 1 },      { { 66, 1 }, 0.78 },   { { 54, 1 }, 0.64 },    { { 42, 1 }, 0.53 },    { { 42, 0.75 }, 0.35 },
    { { 42, 0.5 }, 0.19 }, { { 30, 0.5 }, 0.15 }, { { 30, 0.35 }, 0.09 }, { { 25, 0.25 }, 0.05 },
};

/* exponent by which the bytes of a frame depend on its scale, from the table above */
static const double BYTES_BY_SCALE = 1.45;

/* Returns the size in bytes of a frame of this step and scale, relative to a frame of step 0 and of full size. scale: as in struct
   pacer_note; it may be larger than the scale of the step. */
static double relative_bytes(int step, double scale)
{
    return steps[step].bytes * (scale > 0 ? pow(scale / steps[step].rung.scale, BYTES_BY_SCALE) : 1);
}

/* Returns the expected size in bytes of a preview at this step, in the present size of pictures. */
static double expected_bytes(const struct quality_ladder *ladder, int step)
{
    return ladder->unit_bytes * relative_bytes(step, quality_ladder_rung(ladder, step).scale);
}

void quality_ladder_init(struct quality_ladder *ladder)
{
    *ladder = (struct quality_ladder){ .step = QUALITY_LADDER_FIRST, .patience_ns = MIN_UP_DELAY_NS };
}

int quality_ladder_common(const struct quality_ladder *seen, const int counts[QUALITY_LADDER_STEPS])
{
    int all = 0, below = 0, step = 0;
    for (int i = 0; i < QUALITY_LADDER_STEPS; i++)
        all += counts[i];
    while (all >= MIN_VIEWERS && 4 * (below += counts[step]) < 3 * all)
        step++;
    while (step < QUALITY_LADDER_STEPS - 1 && all * expected_bytes(seen, step) > CROWD_BYTES)
        step++;
    return all >= MIN_VIEWERS ? step : -1;
}

int quality_ladder_step(const struct quality_ladder *ladder, int common)
{
    return common >= 0 && ladder->step <= common + MAX_STEPS_WORSE ? common : ladder->step;
}

struct rung quality_ladder_rung(const struct quality_ladder *ladder, int step)
{
    struct rung rung = steps[step].rung;
    int size = ladder->decoded.index > ladder->made.index ? ladder->decoded.index : ladder->made.index;
    if (picture_size_scale(size) < rung.scale)
        rung.scale = picture_size_scale(size);
    return rung;
}

double quality_ladder_bytes(const struct quality_ladder *ladder)
{
    return expected_bytes(ladder, ladder->step);
}

/* Returns the factor by which the limit on a frame's transfer time is larger at this step. It is 2 for a step whose next one
   has fewer pixels, because viewers at different picture sizes can no longer share frames. For a client that reprojects it is
   1.5 (120 ms in total), which still allows 8 frames a second. */
static double slack_factor(const struct quality_ladder *ladder, int step)
{
    double usual = ladder->reprojects ? 1.5 : 1;
    return step < QUALITY_LADDER_STEPS - 1 && steps[step + 1].rung.scale < 1 ? 2 : usual;
}

/* Returns the best step (the lowest index) whose frames the network is expected to carry within limit_ns. */
static int best_within(const struct quality_ladder *ladder, const struct channel *channel, int64_t limit_ns)
{
    int step = 0;
    while (step < QUALITY_LADDER_STEPS - 1 &&
           (double)channel_transfer_ns(channel, expected_bytes(ladder, step)) > (double)limit_ns * slack_factor(ladder, step))
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

/* Steps down. If the last step up did not hold for LASTED_NS, the delay before the next step up doubles. */
static void go_down(struct quality_ladder *ladder, int step, int64_t now_ns)
{
    if (ladder->up_ns && now_ns - ladder->up_ns < LASTED_NS)
        ladder->patience_ns = ladder->patience_ns * 2 > MAX_UP_DELAY_NS ? MAX_UP_DELAY_NS : ladder->patience_ns * 2;
    else
        ladder->patience_ns = MIN_UP_DELAY_NS;
    ladder->step = step;
    ladder->down_ns = now_ns;
    ladder->good_since_ns = 0;
}

static void follow_network(struct quality_ladder *ladder, const struct channel *channel, int64_t now_ns)
{
    int down = best_within(ladder, channel, SLOW_NS), up = best_within(ladder, channel, FAST_NS);
    bool lags = channel->lag_ns > 2.0 * SLOW_NS * slack_factor(ladder, ladder->step) && ladder->step < QUALITY_LADDER_STEPS - 1 &&
                now_ns - ladder->down_ns >= SETTLE_NS;
    if (down > ladder->step || lags) {
        go_down(ladder, down > ladder->step ? down : ladder->step + 1, now_ns);
    } else if (up >= ladder->step || channel->lag_ns > SLOW_NS) {
        ladder->good_since_ns = 0;
    } else if (!ladder->known) {
        go_up(ladder, up, now_ns); /* steps up without delay, because the initial step was only a guess */
    } else if (!ladder->good_since_ns) {
        ladder->good_since_ns = now_ns;
    } else if (now_ns - ladder->good_since_ns >= ladder->patience_ns) {
        go_up(ladder, up, now_ns);
    }
}

/* Starts measuring again after a pause. If a load of the past is gone, the picture gets its size back at once. */
static void resume(struct quality_ladder *ladder, double took_ns, double easy_ns)
{
    struct picture_size *size = &ladder->made;
    picture_size_pause(size);
    while (size->index > 0 && took_ns * picture_size_ratio(size->index, size->index - 1, MADE_FIXED) < easy_ns) {
        took_ns *= picture_size_ratio(size->index, size->index - 1, MADE_FIXED);
        size->index--;
    }
    ladder->made_ns = took_ns;
}

void quality_ladder_on_made(struct quality_ladder *ladder, int64_t took_ns, int64_t now_ns)
{
    double slack = ladder->reprojects ? REPROJECTED_SLACK : 1, slow_ns = slack * (double)SLOW_MADE_NS;
    int64_t idle_ns = now_ns - took_ns - ladder->made_at_ns;
    double sample_ns = fmin((double)took_ns, (idle_ns < REST_NS ? MOST_MADE : 1) * slow_ns);
    struct picture_cost cost = { .hard_ns = (int64_t)slow_ns, .easy_ns = (int64_t)(slack * (double)FAST_MADE_NS), .fixed = MADE_FIXED };
    if (idle_ns >= IDLE_NS)
        resume(ladder, sample_ns, (double)cost.easy_ns);
    else if (idle_ns >= REST_NS)
        ladder->made.hard_since_ns = 0;
    if (idle_ns < IDLE_NS)
        ladder->made_ns += SAMPLE_WEIGHT * (sample_ns - ladder->made_ns);
    ladder->made_at_ns = now_ns;
    cost.cost_ns = (int64_t)ladder->made_ns;
    int before = ladder->made.index;
    picture_size_follow(&ladder->made, &cost, now_ns);
    ladder->made_ns *= picture_size_ratio(before, ladder->made.index, MADE_FIXED);
}

void quality_ladder_on_ack(struct quality_ladder *ladder, const struct channel *channel, int step, double scale, size_t bytes,
                           int64_t now_ns)
{
    double unit = (double)bytes / relative_bytes(step, scale);
    /* replaces the guess, which was made from the number of pixels, by the first frame's real size */
    ladder->unit_bytes = ladder->known ? ladder->unit_bytes + SAMPLE_WEIGHT * (unit - ladder->unit_bytes) : unit;
    if (channel->ns_per_byte > 0) {
        follow_network(ladder, channel, now_ns);
        ladder->known = true;
    }
    struct picture_cost cost = { .cost_ns = channel->decode_ns, .hard_ns = SLOW_DECODE_NS, .easy_ns = FAST_DECODE_NS };
    picture_size_follow(&ladder->decoded, &cost, now_ns);
}
