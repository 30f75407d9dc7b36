/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "session/pacing/picture_size.h"

#include <stdbool.h>

#include "base/clock.h"

static const int64_t HARD_FOR_NS = 500 * NS_PER_MS, EASY_FOR_NS = 3 * NS_PER_S, MOST_EASY_FOR_NS = 48 * NS_PER_S;
static const int64_t LASTED_NS = 5 * NS_PER_S; /* time after which a larger picture counts as one that holds */

static const double scales[PICTURE_SIZES] = { 1, 0.75, 0.5, 0.35 };

double picture_size_scale(int index)
{
    return scales[index];
}

double picture_size_ratio(int from, int to, double fixed)
{
    return (fixed + (1 - fixed) * scales[to] * scales[to]) / (fixed + (1 - fixed) * scales[from] * scales[from]);
}

/* Returns whether `now`, a condition that the caller checks repeatedly, has been true for limit_ns. *since_ns: keeps the time
   since when it is true; 0: it is false. */
static bool lasts(int64_t *since_ns, bool now, int64_t limit_ns, int64_t now_ns)
{
    if (!now)
        *since_ns = 0;
    else if (!*since_ns)
        *since_ns = now_ns;
    return now && now_ns - *since_ns >= limit_ns;
}

void picture_size_follow(struct picture_size *size, const struct picture_cost *cost, int64_t now_ns)
{
    double ratio = size->index > 0 ? picture_size_ratio(size->index, size->index - 1, cost->fixed) : 1;
    size->patience_ns = size->patience_ns ? size->patience_ns : EASY_FOR_NS;
    bool hard = lasts(&size->hard_since_ns, cost->cost_ns > cost->hard_ns, HARD_FOR_NS, now_ns);
    bool easy = lasts(&size->easy_since_ns, (double)cost->cost_ns * ratio < (double)cost->easy_ns, size->patience_ns, now_ns);
    if (hard && size->index < PICTURE_SIZES - 1) {
        bool held = !size->up_ns || now_ns - size->up_ns >= LASTED_NS;
        size->patience_ns = held ? EASY_FOR_NS : 2 * size->patience_ns;
        size->patience_ns = size->patience_ns < MOST_EASY_FOR_NS ? size->patience_ns : MOST_EASY_FOR_NS;
        size->index++;
    } else if (easy && size->index > 0) {
        size->index--;
        size->up_ns = now_ns;
    }
    if (hard || easy)
        picture_size_pause(size);
}

void picture_size_pause(struct picture_size *size)
{
    size->hard_since_ns = size->easy_since_ns = 0;
}
