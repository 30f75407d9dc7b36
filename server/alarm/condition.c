/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Evaluates the condition of one alarm: compares a value with the alarm's limit, and applies its deadband and delays. */
#include "alarm/condition.h"

enum condition_side condition_side(enum alarm_kind kind, double limit, double deadband, double value)
{
    bool high = kind == ALARM_H || kind == ALARM_HH;
    if (alarm_reaches(value, limit, high))
        return CONDITION_BEYOND;
    return alarm_reaches(value, high ? limit - deadband : limit + deadband, high) ? CONDITION_BETWEEN : CONDITION_CLEAR;
}

bool condition_is_timed(const struct condition *condition)
{
    return condition->pending == CONDITION_COMES || condition->pending == CONDITION_GOES;
}

static bool turn(struct condition *condition)
{
    condition->active = !condition->active;
    condition->pending = CONDITION_RESTS;
    return true;
}

bool condition_advance(struct condition *condition, const struct condition_delays *delays, int64_t now_ns, int64_t *at_ns)
{
    int64_t delay_ns = condition->pending == CONDITION_COMES ? delays->on_ns : delays->off_ns;
    if (!condition_is_timed(condition) || now_ns - condition->since_ns < delay_ns)
        return false;
    *at_ns = condition->since_ns + delay_ns;
    return turn(condition);
}

bool condition_put(struct condition *condition, const struct condition_delays *delays, enum condition_side side, int64_t now_ns)
{
    bool turns = condition->active ? side == CONDITION_CLEAR : side == CONDITION_BEYOND;
    if (!turns) {
        condition->pending = CONDITION_RESTS;
        return false;
    }
    if ((condition->active ? delays->off_ns : delays->on_ns) <= 0)
        return turn(condition);
    if (!condition_is_timed(condition)) {
        condition->since_ns = now_ns - (condition->pending == CONDITION_SUSPENDED ? condition->used_ns : 0);
        condition->pending = condition->active ? CONDITION_GOES : CONDITION_COMES;
    }
    return false;
}

void condition_hold(struct condition *condition, int64_t now_ns)
{
    if (condition->pending == CONDITION_COMES) {
        condition->used_ns = now_ns - condition->since_ns;
        condition->pending = CONDITION_SUSPENDED;
    } else if (condition->pending == CONDITION_GOES) {
        condition->pending = CONDITION_RESTS;
    }
}
