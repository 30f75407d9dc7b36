/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Kinds and states of alarms, their names and priorities, and the limit that a reading violates. Pure functions. Thread: any. */
#ifndef VALUE_ALARM_H
#define VALUE_ALARM_H
#include "plant/plant.h"
#include "value/snapshot.h"

enum alarm_kind {
    ALARM_NONE,
    ALARM_LL, ALARM_L, ALARM_H, ALARM_HH, /* 1 + enum limit */
    ALARM_ON,                             /* a bit of another alarm system is set */
    ALARM_BAD,                            /* the measurement is bad */
    ALARM_LINK,                           /* a device has failed: none of its measurements can be used */
    ALARM_KINDS
};

enum alarm_status { /* the states of ISA-18.2 and IEC 62682, and one for alarms that another system manages */
    ALARM_NORMAL,
    ALARM_ACTIVE, /* only the other system knows whether it was acknowledged */
    ALARM_UNACKNOWLEDGED,
    ALARM_ACKNOWLEDGED,
    ALARM_RETURNED, /* to normal, not acknowledged */
    ALARM_LATCHED,  /* the cause is gone; the alarm stays until it is reset */
    ALARM_SHELVED,
    ALARM_SUPPRESSED, /* by design */
    ALARM_OUT_OF_SERVICE,
    ALARM_STATUSES
};

/* Returns the name of a kind, such as "HH" (static); NULL for ALARM_NONE. */
const char *alarm_kind_name(enum alarm_kind kind);
/* Returns the kind of that name; ALARM_NONE if there is none. */
enum alarm_kind alarm_kind_find(const char *name);
/* Returns the name of a state, such as "out_of_service" (static). */
const char *alarm_status_name(enum alarm_status status);
/* Returns the state of that name; ALARM_STATUSES if there is none. */
enum alarm_status alarm_status_find(const char *name);
/* Returns whether operators see such an alarm: it is neither normal nor shelved, suppressed or out of service. */
bool alarm_status_is_annunciated(enum alarm_status status);
/* Returns whether the cause of such an alarm is gone although the alarm still stands: returned or latched. */
bool alarm_status_is_cleared(enum alarm_status status);

/* Returns the priority of one of a tag's alarms, from 1 (most urgent) to ALARM_PRIORITIES. */
int alarm_priority(const struct plant_tag *tag, enum alarm_kind kind);

/* What decides which of a tag's alarms is shown for all of them: active before cleared, then the more urgent, then the outer limit (which
   implies the inner one), then the unacknowledged. */
struct alarm_grade {
    int priority;
    enum alarm_kind kind;
    enum alarm_status status;
};
/* Returns whether a is shown rather than b. */
bool alarm_graver(const struct alarm_grade *a, const struct alarm_grade *b);

/* Returns the limit that a usable reading is at or beyond, the outer one of two; ALARM_NONE if it is within its limits. */
enum alarm_kind alarm_beyond(const struct plant_tag *tag, const struct reading *reading);
/* Sets the alarms of a snapshot from limits alone, where there is no alarm service: a reading beyond a limit has an active alarm. */
void alarm_by_limits(const struct plant *plant, struct snapshot *snapshot);

#endif
