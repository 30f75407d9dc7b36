/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses the class of frame requests to draw next: inputs, changed readings, refined frames or snapshots. */
#include "service/scheduler.h"

#include "base/clock.h"

/* time in nanoseconds after a frame for a moving camera during which the scheduler draws nothing else, because that camera's
   next position is expected */
static const int64_t INPUT_PAUSE_NS = 150 * NS_PER_MS;
/* maximum time in nanoseconds by which slow frames (refined ones, snapshots over HTTP) are postponed while cameras move */
static const int64_t LONG_TURN_NS = 3 * NS_PER_S;
/* maximum time in nanoseconds by which snapshots over HTTP are postponed while cameras move; shorter, because their clients
   have no frame to look at yet */
static const int64_t SNAPSHOT_TURN_NS = 1 * NS_PER_S;

int scheduler_share(enum urgency urgency)
{
    return urgency >= URGENCY_REFINE ? SCHEDULER_LONG : SCHEDULER_MOVING;
}

int64_t scheduler_asked(int64_t spent_ns, int64_t served_ns)
{
    return spent_ns > served_ns ? spent_ns : served_ns;
}

bool scheduler_before(int64_t a_spent_ns, int64_t a_asked_ns, int64_t b_spent_ns, int64_t b_asked_ns)
{
    return a_spent_ns < b_spent_ns || (a_spent_ns == b_spent_ns && a_asked_ns < b_asked_ns);
}

static bool is_pending(int64_t asked_ns)
{
    return asked_ns != INT64_MAX;
}

static bool share_due(const struct scheduler *scheduler, enum urgency urgency, int64_t asked_ns, int64_t now_ns)
{
    int64_t share_ns = urgency == URGENCY_SNAPSHOT ? SNAPSHOT_TURN_NS : LONG_TURN_NS;
    return scheduler->step_next && is_pending(asked_ns) && now_ns - asked_ns >= share_ns && now_ns - scheduler->long_ns >= share_ns;
}

enum urgency scheduler_choose(const struct scheduler *scheduler, const int64_t asked_ns[URGENCY_COUNT], int64_t now_ns,
                              int64_t *wait_until_ns)
{
    bool input = is_pending(asked_ns[URGENCY_INPUT]), data = is_pending(asked_ns[URGENCY_DATA]);
    enum urgency slow = asked_ns[URGENCY_SNAPSHOT] < asked_ns[URGENCY_REFINE] ? URGENCY_SNAPSHOT : URGENCY_REFINE;
    *wait_until_ns = INT64_MAX;
    if (share_due(scheduler, slow, asked_ns[slow], now_ns))
        return slow;
    if (input && !(data && scheduler->data_next))
        return URGENCY_INPUT;
    if (data)
        return URGENCY_DATA;
    if (!is_pending(asked_ns[slow]))
        return URGENCY_COUNT;
    if (now_ns - scheduler->input_ns >= INPUT_PAUSE_NS)
        return slow;
    *wait_until_ns = scheduler->input_ns + INPUT_PAUSE_NS;
    return URGENCY_COUNT;
}

void scheduler_done(struct scheduler *scheduler, enum urgency urgency, int64_t now_ns)
{
    scheduler->step_next = urgency == URGENCY_INPUT || urgency == URGENCY_DATA;
    if (scheduler->step_next)
        scheduler->data_next = urgency == URGENCY_INPUT;
    if (urgency == URGENCY_INPUT)
        scheduler->input_ns = now_ns;
    else if (urgency != URGENCY_DATA)
        scheduler->long_ns = now_ns;
}

void scheduler_stepped(struct scheduler *scheduler)
{
    scheduler->step_next = false;
}
