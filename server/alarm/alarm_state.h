/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State machine of one alarm (ISA-18.2, alarm state transition diagram). Pure. Thread: any. */
#ifndef ALARM_ALARM_STATE_H
#define ALARM_ALARM_STATE_H
#include <stdbool.h>
#include <stdint.h>

#include "value/alarm.h"

enum alarm_event {
    ALARM_RAISE, /* its cause has come */
    ALARM_CLEAR,
    ALARM_ACKNOWLEDGE,
    ALARM_RESET, /* of a latched alarm */
    ALARM_SHELVE, /* also of a shelved alarm, for another time */
    ALARM_UNSHELVE, /* by hand, or because its time is over */
    ALARM_SUPPRESS,
    ALARM_UNSUPPRESS,
    ALARM_TAKE_OUT, /* of service */
    ALARM_PUT_BACK,
    ALARM_CARRY, /* it is suppressed: the alarm of its device stands for it */
    ALARM_CALL,  /* the alarm of its device does not stand for it any more */
    ALARM_EVENTS
};

enum { ALARM_ASIDE_SHELVED = 1, ALARM_ASIDE_SUPPRESSED = 2, ALARM_ASIDE_OUT = 4, ALARM_ASIDE_CARRIED = 8, ALARM_ASIDE_ALL = 15 };

struct alarm_state { /* zero-initialised: normal */
    bool active;         /* its cause is present */
    bool unacknowledged; /* never while aside is not 0 */
    bool latched;
    uint8_t aside;       /* ALARM_ASIDE_... */
};

struct alarm_rule {
    bool acknowledges; /* operators here acknowledge it; else it is only active or normal */
    bool latches;
    bool forgets;      /* it becomes normal when its cause goes: acknowledging it afterwards is not possible */
    bool carried;      /* if it is raised now, the alarm of its device stands for it */
};

enum alarm_outcome { ALARM_CHANGED, ALARM_AS_IT_WAS, ALARM_REFUSED /* not possible in this state */ };

/* Applies an event to a state and returns what came of it. */
enum alarm_outcome alarm_state_step(struct alarm_state *state, const struct alarm_rule *rule, enum alarm_event event);
/* Returns the state as one word of ISA-18.2. */
enum alarm_status alarm_state_status(const struct alarm_state *state, const struct alarm_rule *rule);
const char *alarm_event_name(enum alarm_event event); /* returns its name, such as "acknowledge" (static) */

#endif
