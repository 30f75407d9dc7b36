/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All alarms of a plant, as they follow from samples, time and what operators do. Pure: time is an argument, and changes go to a listener.
   Thread: one at a time. */
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
    const char *name;          /* of its tag, or of its device (alarm/devices.h) */
    int tag;                   /* -1: of a device; kind is ALARM_LINK then */
    enum alarm_kind kind;
    int priority;              /* 1 is the most urgent */
    double limit;              /* NaN: none */
    struct alarm_rule rule;
    struct alarm_state state;
    bool acknowledged_there;   /* acknowledged in another alarm system, as a bit of it says */
    bool held;                 /* its measurement is bad: it keeps its last state */
    double value;              /* when it was raised; NaN: none */
    int64_t raised_utc_ns;     /* 0: never */
    int64_t changed_utc_ns;    /* when it last changed */
    struct instant until;      /* when shelving ends; 0: not shelved */
    char who[ALARM_NAME_BYTES], reason[ALARM_REASON_BYTES]; /* of the last action of a person; "": none */
    uint64_t number;           /* of its last change, among those of all alarms; 0: it never changed */
    /* --- below: private to alarms*.c */
    struct condition condition;
    struct condition_delays delays;
    int64_t raised_mono_ns, recent_ns[ALARM_RECENT]; /* when it was raised last; a ring of the last times */
    unsigned raised_count;
    int older, newer;          /* by number; -1: none */
    bool timed;                /* it may change when time passes */
};

/* One change of one alarm, as the listener gets it. */
struct alarm_change {
    const struct alarm *alarm; /* as it is now */
    enum alarm_event event;
    enum alarm_status before, after;
    int64_t utc_ns;
    double value;              /* of the sample; NaN: none */
    const char *who, *reason;  /* "": nobody, none */
};

struct alarms_listener {
    void (*changed)(void *arg, const struct alarm_change *change);
    /* The alarm that is shown for a tag is another one, or in another state. */
    void (*of_tag)(void *arg, int tag, enum alarm_kind kind, enum alarm_status status);
    void *arg;
};

struct alarms;
/* Makes the alarms of a plant, all normal. plant must outlive them; the listener is copied. Never returns NULL. */
struct alarms *alarms_create(const struct plant *plant, const struct alarms_listener *listener);
void alarms_destroy(struct alarms **alarms); /* &NULL is fine; leaves NULL */

/* Updates alarms by sample events of the store, in their order. */
void alarms_put(struct alarms *alarms, const struct sample_event *event, size_t count);
/* Updates alarms by the passing of time: delays, shelving, and readings that went bad without an event because they are stale. */
void alarms_tick(struct alarms *alarms, const struct snapshot *now);

struct alarm_act {
    enum alarm_event event;    /* ACKNOWLEDGE, RESET, SHELVE, UNSHELVE, TAKE_OUT or PUT_BACK */
    int64_t for_ns;            /* SHELVE: how long, at most ALARM_LONGEST_SHELF_NS */
    const char *who, *reason;
};
/* Does what an operator asks for, to the alarm of that index. Returns NULL, or why it was refused (static). */
enum refusal_code alarms_act(struct alarms *alarms, int index, const struct alarm_act *act, struct instant now);

/* --- queries --- */
size_t alarms_count(const struct alarms *alarms);
const struct alarm *alarms_at(const struct alarms *alarms, int index);
int alarms_find(const struct alarms *alarms, int tag, enum alarm_kind kind); /* returns the index, or -1 */
int alarms_find_named(const struct alarms *alarms, const char *name, enum alarm_kind kind); /* likewise; ALARM_LINK: name of a device */
enum alarm_status alarm_status_of(const struct alarm *alarm);       /* returns its state as one word */
uint64_t alarms_number(const struct alarms *alarms);                 /* returns the number of the last change of any alarm */
/* Returns the index of the alarm that changed last, or -1; go on with ->older. */
int alarms_newest(const struct alarms *alarms);

struct alarm_counts {
    int statuses[ALARM_STATUSES];
    int active;      /* annunciated, and their cause is present */
    int standing;    /* of these, for longer than a day */
    int chattering;  /* raised three times or more within the last minute */
    int held;
    int priorities[ALARM_PRIORITIES]; /* annunciated, by priority; the first is 1 */
};
#define ALARM_STANDING_NS (86400 * INT64_C(1000000000))
#define ALARM_CHATTERING_NS (60 * INT64_C(1000000000))
/* Counts alarms by state. */
void alarms_counts(const struct alarms *alarms, int64_t now_mono_ns, struct alarm_counts *out);

/* --- restoring --- */
/* Sets an alarm to a state from the journal. The listener only gets the alarm that is shown for the tag. States that do not exist in the
   alarm mode of this plant are dropped. */
void alarms_restore(struct alarms *alarms, int index, const struct alarm *saved, struct instant now);
/* Sets alarms, by name and kind, to what another daemon says they are, in that order; whole: all others are normal. Returns false if one is
   not there; then nothing changed. */
bool alarms_mirror(struct alarms *alarms, const struct alarm *list, size_t count, bool whole);
/* Ends mirroring: alarms go on from the states that they were set to, each held until its next sample. */
void alarms_lead(struct alarms *alarms, struct instant now);
/* Takes over the states of alarms of the same tag and kind from another plant, including running delays. */
void alarms_adopt(struct alarms *alarms, const struct alarms *before);

#endif
