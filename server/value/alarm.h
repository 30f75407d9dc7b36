/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Kinds and states of alarms, their names and priorities, and the limit that a reading has passed. No side effects. Call from any
   thread. */
#ifndef VALUE_ALARM_H
#define VALUE_ALARM_H
#include "plant/plant.h"
#include "value/snapshot.h"

enum alarm_kind {
    ALARM_NONE,
    ALARM_LL,
    ALARM_L,
    ALARM_H,
    ALARM_HH,   /* ALARM_LL to ALARM_HH: the reading is beyond this limit of the tag; values are 1 + the limit's value in enum limit */
    ALARM_ON,   /* the alarm is active because another alarm system has set the tag's bit */
    ALARM_BAD,  /* the quality of the tag's reading is Bad (OPC UA severity) */
    ALARM_LINK, /* a device does not answer, so that the readings of all its tags are unusable */
    ALARM_KINDS
};

enum alarm_status { /* alarm states of ISA-18.2 and IEC 62682, plus ALARM_ACTIVE */
                    ALARM_NORMAL,
                    ALARM_ACTIVE, /* the alarm is active; another alarm system manages it, so whether it is acknowledged is unknown */
                    ALARM_UNACKNOWLEDGED,
                    ALARM_ACKNOWLEDGED,
                    ALARM_RETURNED, /* the cause of the alarm is gone, but nobody has acknowledged the alarm yet */
                    ALARM_LATCHED,  /* the cause of the alarm is gone, but the alarm is latched: it remains until an operator resets it */
                    ALARM_SHELVED,
                    ALARM_SUPPRESSED, /* a LINK alarm replaces it, or the `Suppressed By` tag is 1 (ISA-18.2: suppressed by design) */
                    ALARM_OUT_OF_SERVICE,
                    ALARM_STATUSES
};

/* Returns the name of an alarm kind, such as "HH" (static); NULL for ALARM_NONE. */
const char *alarm_kind_name(enum alarm_kind kind);
/* Returns the alarm kind with this name; ALARM_NONE if there is none. */
enum alarm_kind alarm_kind_find(const char *name);
/* Returns the name of an alarm state, such as "out_of_service" (static). */
const char *alarm_status_name(enum alarm_status status);
/* Returns the alarm state with this name; ALARM_STATUSES if there is none. */
enum alarm_status alarm_status_find(const char *name);
/* Returns true if operators see an alarm in this state; false if the state is normal, shelved, suppressed or out of service. */
bool alarm_status_is_annunciated(enum alarm_status status);
/* Returns true if the cause of an alarm in this state is gone although the alarm remains: ALARM_RETURNED or ALARM_LATCHED. */
bool alarm_status_is_cleared(enum alarm_status status);

/* Returns the priority of a tag's alarm of this kind, from 1 (most urgent) to ALARM_PRIORITIES. */
int alarm_priority(const struct plant_tag *tag, enum alarm_kind kind);

/* Sort key of the alarms of one tag; the tag shows the alarm that comes first. Active alarms come before alarms whose cause is
   gone. Among these, the more urgent priority comes first, then the outer limit (HH before H), then the unacknowledged alarm. */
struct alarm_grade {
    int priority;
    enum alarm_kind kind;
    enum alarm_status status;
};
/* Returns true if alarm `a` comes before alarm `b` in the order of struct alarm_grade. */
bool alarm_graver(const struct alarm_grade *a, const struct alarm_grade *b);

/* Returns true if a value is at or above a high limit, or at or below a low one; false if the limit is NaN (not configured).
   Compares with the precision of 32-bit floats. A device's 32-bit value or a scaled value may differ from an equal limit in the
   last digits, such as 55.5 and 55.50000000000001. */
bool alarm_reaches(double value, double limit, bool high);
/* Returns the kind of the limit that a usable reading has reached or passed; if it passed two, the outer one. ALARM_NONE if the
   reading is within limits. */
enum alarm_kind alarm_beyond(const struct plant_tag *tag, const struct reading *reading);
/* Sets the alarms of a snapshot from the tags' limits alone: each reading beyond a limit has an active alarm. For daemons
   without an alarm service. */
void alarm_by_limits(const struct plant *plant, struct snapshot *snapshot);

#endif
