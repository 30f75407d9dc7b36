/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State machine of one alarm (ISA-18.2, alarm state transition diagram). No input or output. Call from any thread. */
#ifndef ALARM_ALARM_STATE_H
#define ALARM_ALARM_STATE_H
#include <stdbool.h>
#include <stdint.h>

#include "value/alarm.h"

enum alarm_event {
    ALARM_RAISE, /* the alarm's cause is present, for example a value beyond the limit */
    ALARM_CLEAR,
    ALARM_ACKNOWLEDGE,
    ALARM_RESET,    /* resets a latched alarm */
    ALARM_SHELVE,   /* silences the alarm for a time; also valid for a shelved alarm, to change when its shelving ends */
    ALARM_UNSHELVE, /* ends shelving, either on an operator's request or because its time is over */
    ALARM_SUPPRESS,
    ALARM_UNSUPPRESS,
    ALARM_TAKE_OUT, /* an operator takes the alarm out of service */
    ALARM_PUT_BACK,
    ALARM_CARRY, /* suppresses the BAD alarm of a tag, because the alarm of the tag's device reports the failure */
    ALARM_CALL,  /* ends ALARM_CARRY, because the device's alarm no longer reports the tag's failure */
    ALARM_EVENTS
};

enum { ALARM_ASIDE_SHELVED = 1, ALARM_ASIDE_SUPPRESSED = 2, ALARM_ASIDE_OUT = 4, ALARM_ASIDE_CARRIED = 8, ALARM_ASIDE_ALL = 15 };

struct alarm_state {     /* state of one alarm; all zero: normal */
    bool active;         /* true: the alarm's cause is present */
    bool unacknowledged; /* true: an operator must still acknowledge the alarm */
    bool latched;
    /* bit mask of ALARM_ASIDE_...: reasons why operators are not shown the alarm as active; 0: no reason, so they are shown it */
    uint8_t aside;
};

struct alarm_rule {
    bool acknowledges; /* true: operators must acknowledge the alarm; false: the alarm is only ever active or normal */
    bool latches;
    bool forgets; /* true: the alarm becomes normal when its cause ends, even if unacknowledged */
    /* true: if the alarm is raised now, it is suppressed, because the device's alarm already reports the failure */
    bool carried;
};

enum alarm_outcome { ALARM_CHANGED, ALARM_AS_IT_WAS, ALARM_REFUSED /* the present state does not allow the event */ };

/* Applies an event to an alarm's state. Returns whether the state changed, stayed the same, or does not allow the event. */
enum alarm_outcome alarm_state_step(struct alarm_state *state, const struct alarm_rule *rule, enum alarm_event event);
/* Returns the alarm's ISA-18.2 state. */
enum alarm_status alarm_state_status(const struct alarm_state *state, const struct alarm_rule *rule);
const char *alarm_event_name(enum alarm_event event); /* returns the event's name, such as "acknowledge" (static text) */

#endif
