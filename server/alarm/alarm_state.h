/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How one alarm is, and what becomes of it (ISA-18.2, figure of the alarm state transitions). Pure. Thread: any. */
#ifndef ALARM_ALARM_STATE_H
#define ALARM_ALARM_STATE_H
#include <stdbool.h>
#include <stdint.h>

#include "value/alarm.h"

enum alarm_event {
    ALARM_RAISE, /* its cause is there */
    ALARM_CLEAR,
    ALARM_ACKNOWLEDGE,
    ALARM_RESET,    /* of what is latched */
    ALARM_SHELVE,   /* also anew */
    ALARM_UNSHELVE, /* by hand, or because its time is over */
    ALARM_SUPPRESS,
    ALARM_UNSUPPRESS,
    ALARM_TAKE_OUT, /* of service */
    ALARM_PUT_BACK,
    ALARM_CARRY, /* the alarm of its device stands for it, from now on */
    ALARM_CALL,  /* it does not any more */
    ALARM_EVENTS
};

enum { ALARM_ASIDE_SHELVED = 1, ALARM_ASIDE_SUPPRESSED = 2, ALARM_ASIDE_OUT = 4, ALARM_ASIDE_CARRIED = 8, ALARM_ASIDE_ALL = 15 };

struct alarm_state {     /* zero-initialised: normal */
    bool active;         /* its cause is there */
    bool unacknowledged; /* never while it is set aside */
    bool latched;
    uint8_t aside; /* ALARM_ASIDE_... */
};

struct alarm_rule {
    bool acknowledges; /* somebody here has to; else it is only active or not */
    bool latches;
    bool forgets; /* who acknowledges what is gone, is not known */
    bool carried; /* when it is raised now, the alarm of its device stands for it */
};

enum alarm_outcome { ALARM_CHANGED, ALARM_AS_IT_WAS, ALARM_REFUSED /* it is not in a state for that */ };

enum alarm_outcome alarm_state_step(struct alarm_state *state, const struct alarm_rule *rule, enum alarm_event event);
enum alarm_status alarm_state_status(const struct alarm_state *state, const struct alarm_rule *rule);
const char *alarm_event_name(enum alarm_event event); /* "acknowledge" */

#endif
