/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State machine of one alarm: how events change its state. */
#include "alarm/alarm_state.h"

static const char *const event_names[ALARM_EVENTS] = { "raise",    "clear",      "acknowledge",    "reset",      "shelve", "unshelve",
                                                       "suppress", "unsuppress", "out_of_service", "in_service", "carry",  "call" };

const char *alarm_event_name(enum alarm_event event)
{
    return event_names[event];
}

/* Makes an alarm require acknowledgement, and latches it if its rule says so. */
static void call(struct alarm_state *state, const struct alarm_rule *rule)
{
    state->unacknowledged = rule->acknowledges;
    state->latched |= rule->acknowledges && rule->latches;
}

static enum alarm_outcome raise_it(struct alarm_state *state, const struct alarm_rule *rule)
{
    if (state->active)
        return ALARM_AS_IT_WAS;
    state->active = true;
    if (rule->carried) {
        state->aside |= ALARM_ASIDE_CARRIED;
        state->unacknowledged = false;
    }
    if (!state->aside)
        call(state, rule);
    return ALARM_CHANGED;
}

static enum alarm_outcome clear_it(struct alarm_state *state, const struct alarm_rule *rule)
{
    if (!state->active)
        return ALARM_AS_IT_WAS;
    state->active = false;
    state->aside &= (uint8_t)~ALARM_ASIDE_CARRIED;
    state->unacknowledged &= !rule->forgets;
    return ALARM_CHANGED;
}

static enum alarm_outcome acknowledge(struct alarm_state *state)
{
    if (!state->unacknowledged)
        return ALARM_REFUSED;
    state->unacknowledged = false;
    return ALARM_CHANGED;
}

/* Resets a latched alarm (one that outlasts its cause). Refused while the alarm is unacknowledged, so that no alarm disappears unseen. */
static enum alarm_outcome reset(struct alarm_state *state)
{
    if (!state->latched || state->active || state->unacknowledged || state->aside)
        return ALARM_REFUSED;
    state->latched = false;
    return ALARM_CHANGED;
}

static enum alarm_outcome set_aside(struct alarm_state *state, int how)
{
    if (state->aside & how & ~ALARM_ASIDE_SHELVED)
        return ALARM_AS_IT_WAS;
    state->aside |= (uint8_t)how;
    state->unacknowledged = false;
    return ALARM_CHANGED;
}

/* Ends one reason for hiding the alarm: suppressed, shelved or out of service. If the alarm is active and no reason remains, it
   is shown as if it were new. */
static enum alarm_outcome bring_back(struct alarm_state *state, const struct alarm_rule *rule, int how)
{
    if (!(state->aside & how))
        return ALARM_AS_IT_WAS;
    state->aside &= (uint8_t)~how;
    if (!state->aside && state->active)
        call(state, rule);
    return ALARM_CHANGED;
}

enum alarm_outcome alarm_state_step(struct alarm_state *state, const struct alarm_rule *rule, enum alarm_event event)
{
    switch (event) {
    case ALARM_RAISE: return raise_it(state, rule);
    case ALARM_CLEAR: return clear_it(state, rule);
    case ALARM_ACKNOWLEDGE: return acknowledge(state);
    case ALARM_RESET: return reset(state);
    case ALARM_SHELVE: return set_aside(state, ALARM_ASIDE_SHELVED);
    case ALARM_UNSHELVE: return bring_back(state, rule, ALARM_ASIDE_SHELVED);
    case ALARM_SUPPRESS: return set_aside(state, ALARM_ASIDE_SUPPRESSED);
    case ALARM_UNSUPPRESS: return bring_back(state, rule, ALARM_ASIDE_SUPPRESSED);
    case ALARM_TAKE_OUT: return set_aside(state, ALARM_ASIDE_OUT);
    case ALARM_PUT_BACK: return bring_back(state, rule, ALARM_ASIDE_OUT);
    case ALARM_CARRY: return state->active ? set_aside(state, ALARM_ASIDE_CARRIED) : ALARM_AS_IT_WAS;
    case ALARM_CALL: return bring_back(state, rule, ALARM_ASIDE_CARRIED);
    case ALARM_EVENTS: break;
    }
    return ALARM_REFUSED;
}

enum alarm_status alarm_state_status(const struct alarm_state *state, const struct alarm_rule *rule)
{
    if (state->aside & ALARM_ASIDE_OUT)
        return ALARM_OUT_OF_SERVICE;
    if (state->aside & ALARM_ASIDE_SUPPRESSED)
        return ALARM_SUPPRESSED;
    if (state->aside & ALARM_ASIDE_SHELVED)
        return ALARM_SHELVED;
    if (state->aside & ALARM_ASIDE_CARRIED)
        return ALARM_SUPPRESSED;
    if (state->active)
        return !rule->acknowledges ? ALARM_ACTIVE : state->unacknowledged ? ALARM_UNACKNOWLEDGED : ALARM_ACKNOWLEDGED;
    if (state->latched)
        return ALARM_LATCHED;
    return state->unacknowledged ? ALARM_RETURNED : ALARM_NORMAL;
}
