/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All alarms of a plant, driven by samples, time and operators' actions. No input or output: the caller passes the time, and a
   listener receives the changes. Call from one thread at a time. */
#ifndef ALARM_ALARMS_H
#define ALARM_ALARMS_H
#include <stddef.h>

#include "alarm/alarm_state.h"
#include "alarm/condition.h"
#include "base/refusal.h"
#include "plant/plant.h"
#include "value/snapshot.h"
#include "value/store.h"

enum { ALARM_NAME_BYTES = 64, ALARM_REASON_BYTES = 240, ALARM_RECENT = 3 };
#define ALARM_LONGEST_SHELF_NS (7 * 86400 * INT64_C(1000000000))

struct instant {
    int64_t mono_ns, utc_ns;
};

struct alarm {
    const char *name; /* name of the alarm's tag or, for a LINK alarm, of its device (alarm/devices.h) */
    int tag;          /* index of the alarm's tag; -1: the alarm belongs to a device, and kind is ALARM_LINK */
    enum alarm_kind kind;
    int priority; /* priority of the alarm; 1 is the most urgent */
    double limit; /* limit beyond which the tag's value raises the alarm; NaN: the alarm has no limit */
    struct alarm_rule rule;
    struct alarm_state state;
    /* true: the other alarm system, which this alarm mirrors, reports the alarm as acknowledged */
    bool acknowledged_there;
    bool held;                                              /* true: the alarm keeps its last state, because the tag's value is Bad */
    double value;                                           /* the tag's value when the alarm was raised; NaN: no value */
    int64_t raised_utc_ns;                                  /* UTC time when the alarm was last raised; 0: never */
    int64_t changed_utc_ns;                                 /* UTC time when the alarm's state last changed */
    struct instant until;                                   /* when shelving of the alarm ends; 0: the alarm is not shelved */
    char who[ALARM_NAME_BYTES], reason[ALARM_REASON_BYTES]; /* operator who last acted on the alarm, and the reason given; empty: none */
    uint64_t number; /* change number (among all alarms of the plant) of this alarm's last change; 0: the alarm never changed */
    /* --- below: private to alarms*.c */
    struct condition condition;
    struct condition_delays delays;
    bool acknowledgement_bad; /* true: the other system's acknowledgement bit is Bad, so acknowledged_there is its last known state */
    /* true: the shelving was restored. It also ends at until.utc_ns, because the clock may have been wrong at the start */
    bool until_restored;
    /* raised_mono_ns: monotonic time when the alarm was last raised; recent_ns: ring buffer of the last such times */
    int64_t raised_mono_ns, recent_ns[ALARM_RECENT];
    unsigned raised_count;
    /* list of alarms sorted by their last change: older, newer: index of the alarm that changed before and after this one; -1:
       none */
    int older, newer;
    bool timed;       /* true: the alarm can change by the passing of time alone, so its index is in alarms->timed */
};

/* One change of one alarm, as alarms_listener receives it. */
struct alarm_change {
    const struct alarm *alarm; /* the alarm, already in its new state */
    enum alarm_event event;
    enum alarm_status before, after;
    int64_t utc_ns;
    double value;             /* value of the sample that caused the change of the alarm; NaN: no sample did */
    const char *who, *reason; /* operator who changed the alarm, and the reason given; "": no operator did */
};

struct alarms_listener {
    void (*changed)(void *arg, const struct alarm_change *change);
    /* called when another alarm becomes a tag's most urgent one, or that alarm's state changes */
    void (*of_tag)(void *arg, int tag, enum alarm_kind kind, enum alarm_status status);
    void *arg;
};

struct alarms;
/* Creates the alarms of a plant, all normal. `plant` must outlive the alarms; the listener is copied. Never returns NULL. */
struct alarms *alarms_create(const struct plant *plant, const struct alarms_listener *listener);
void alarms_destroy(struct alarms **alarms); /* frees the alarms and sets *alarms to NULL; accepts a pointer to NULL */

/* Evaluates the store's sample events in the order of the array. */
void alarms_put(struct alarms *alarms, const struct sample_event *event, size_t count);
/* Applies the passing of time: ends delays and shelving. Readings in `now` that have become stale count as Bad samples, because
   no event reports them. After alarms_adopt(), evaluates every present reading once as a new sample. */
void alarms_tick(struct alarms *alarms, const struct snapshot *now);

struct alarm_act {
    enum alarm_event event; /* action of the operator: ALARM_ACKNOWLEDGE, RESET, SHELVE, UNSHELVE, TAKE_OUT or PUT_BACK */
    int64_t for_ns;         /* for ALARM_SHELVE: duration, at most ALARM_LONGEST_SHELF_NS */
    const char *who, *reason;
};
/* Carries out an operator's action on the alarm with that index. Returns REFUSAL_NONE, or why it was refused. */
enum refusal_code alarms_act(struct alarms *alarms, int index, const struct alarm_act *act, struct instant now);

/* --- queries --- */
const struct alarm *alarms_at(const struct alarms *alarms, int index);
int alarms_find(const struct alarms *alarms, int tag, enum alarm_kind kind); /* returns the index of a tag's alarm of that kind, or -1 */
/* Returns the index of an alarm, or -1. name: name of the tag; for a LINK alarm, of the device. */
int alarms_find_named(const struct alarms *alarms, const char *name, enum alarm_kind kind);
/* returns the unit of the alarm's value and limit; "": none */
const char *alarm_unit(const struct alarms *alarms, const struct alarm *alarm);
enum alarm_status alarm_status_of(const struct alarm *alarm); /* returns the alarm's ISA-18.2 state */
uint64_t alarms_number(const struct alarms *alarms);          /* returns the number of alarm changes so far */
/* Returns the index of the alarm that changed last, or -1 if none has changed; the alarm's member `older` is the index of the
   one that changed before it. */
int alarms_newest(const struct alarms *alarms);

struct alarm_counts {
    int statuses[ALARM_STATUSES];
    int active;     /* number of alarms whose cause is present and that are shown to operators */
    int standing;   /* number of alarms in `active` that have been active for longer than a day */
    int chattering; /* number of alarms raised three times or more within the last minute */
    int held;
    int priorities[ALARM_PRIORITIES]; /* number of alarms shown to operators, by priority; index 0 is priority 1 */
};
#define ALARM_STANDING_NS (86400 * INT64_C(1000000000))
#define ALARM_CHATTERING_NS (60 * INT64_C(1000000000))
/* Counts alarms by state. */
void alarms_counts(const struct alarms *alarms, int64_t now_mono_ns, struct alarm_counts *out);

/* --- restoring --- */
/* Converts an alarm's value or limit from the unit `was` to the unit `is`; NaN if the units cannot be converted. A blank unit
   matches every unit. */
double alarm_value_in_unit(double value, const char *was, const char *is);
/* Sets an alarm to a state that was saved in the journal. Calls the listener's of_tag() (the tag's most urgent alarm), but not
   changed(). Drops parts of the state that the plant's current alarm settings do not support. */
void alarms_restore(struct alarms *alarms, int index, const struct alarm *saved, struct instant now);
/* Sets alarms, found by name and kind, to the states of another daemon, in the order of `list`. whole: all alarms that are not in `list`
   become normal. Returns false if an alarm does not exist; then nothing changed. */
bool alarms_mirror(struct alarms *alarms, const struct alarm *list, size_t count, bool whole);
/* Returns true if `before`, an alarm of an earlier plant or run, was not normal, but is normal or missing in `alarms`. */
bool alarms_is_ended(const struct alarms *alarms, const struct alarm *before);
/* Ends the mirroring (copying) of another daemon's alarm states. Each alarm keeps the state copied last until its tag's next
   sample. */
void alarms_lead(struct alarms *alarms, struct instant now);
/* After a reload: copies states and running delays from the old plant's alarms to alarms of the same name and kind. The next
   alarms_tick() compares the present readings with the new plant's limits. */
void alarms_adopt(struct alarms *alarms, const struct alarms *before);

#endif
