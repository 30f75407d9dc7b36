/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All alarms of a plant: made of samples, time and what people do. Pure: clocks are handed in, and what changes is told to whoever
   listens. Thread: one at a time. */
#ifndef ALARM_ALARMS_H
#define ALARM_ALARMS_H
#include <stddef.h>

#include "alarm/alarm_state.h"
#include "alarm/condition.h"
#include "plant/plant.h"
#include "value/snapshot.h"
#include "value/store.h"

enum { ALARM_NAME_BYTES = 64, ALARM_REASON_BYTES = 240, ALARM_RECENT = 3 };
#define ALARM_LONGEST_SHELF_NS (7 * 86400 * INT64_C(1000000000))

struct instant {
    int64_t mono_ns, utc_ns;
};

struct alarm {
    const char *name; /* of its tag, or of its device (alarm/devices.h) */
    int tag;          /* -1: of a device; kind is ALARM_LINK then */
    enum alarm_kind kind;
    int priority; /* 1 is the most urgent */
    double limit; /* NaN: none */
    struct alarm_rule rule;
    struct alarm_state state;
    bool acknowledged_there;                                /* as a bit of another alarm system says */
    bool held;                                              /* its measurement is bad: it is as it last was */
    double value;                                           /* when it was raised; NaN: none */
    int64_t raised_utc_ns;                                  /* 0: never */
    int64_t changed_utc_ns;                                 /* when it last changed */
    struct instant until;                                   /* of a shelf; 0: none */
    char who[ALARM_NAME_BYTES], reason[ALARM_REASON_BYTES]; /* of the last that was done by somebody; "": nobody */
    uint64_t number;                                        /* of its last change; 0: it never changed */
    /* --- below: of alarms.c */
    struct condition condition;
    struct condition_delays delays;
    int64_t raised_mono_ns, recent_ns[ALARM_RECENT]; /* when it was raised last; a ring */
    unsigned raised_count;
    int older, newer; /* by number; -1: none */
    bool timed;       /* is looked at when time passes */
};

/* What happened to one. */
struct alarm_change {
    const struct alarm *alarm; /* as it is now */
    enum alarm_event event;
    enum alarm_status before, after;
    int64_t utc_ns;
    double value;             /* of the sample; NaN: none */
    const char *who, *reason; /* "": nobody, none */
};

struct alarms_listener {
    void (*changed)(void *arg, const struct alarm_change *change);
    void (*of_tag)(void *arg, int tag, enum alarm_kind kind, enum alarm_status status); /* the gravest of a tag is another, or otherwise */
    void *arg;
};

struct alarms;
struct alarms *alarms_create(const struct plant *plant, const struct alarms_listener *listener); /* plant outlives it */
void alarms_destroy(struct alarms **alarms);                                                     /* &NULL is fine; leaves NULL */

/* What a store told, in its order, and what readings are by now: some go bad without being told. utc_ns belongs to mono_ns. */
void alarms_put(struct alarms *alarms, const struct sample_event *event, size_t count);
void alarms_tick(struct alarms *alarms, const struct snapshot *now);

struct alarm_act {
    enum alarm_event event; /* ACKNOWLEDGE, RESET, SHELVE, UNSHELVE, TAKE_OUT or PUT_BACK */
    int64_t for_ns;         /* SHELVE: how long, at most ALARM_LONGEST_SHELF_NS */
    const char *who, *reason;
};
/* NULL: it was done. Else why not (static). */
const char *alarms_act(struct alarms *alarms, int index, const struct alarm_act *act, struct instant now);

/* --- what there is --- */
size_t alarms_count(const struct alarms *alarms);
const struct alarm *alarms_at(const struct alarms *alarms, int index);
int alarms_find(const struct alarms *alarms, int tag, enum alarm_kind kind);                /* index or -1 */
int alarms_find_named(const struct alarms *alarms, const char *name, enum alarm_kind kind); /* likewise; ALARM_LINK: name of a device */
enum alarm_status alarm_status_of(const struct alarm *alarm);
uint64_t alarms_number(const struct alarms *alarms); /* of the last change of any */
int alarms_newest(const struct alarms *alarms);      /* the one that changed last, then ->older; -1: none */

struct alarm_counts {
    int statuses[ALARM_STATUSES];
    int active;     /* to be seen, and their cause is there */
    int standing;   /* of these, for longer than a day */
    int chattering; /* raised three times or more within the last minute */
    int held;
};
#define ALARM_STANDING_NS (86400 * INT64_C(1000000000))
#define ALARM_CHATTERING_NS (60 * INT64_C(1000000000))
void alarms_counts(const struct alarms *alarms, int64_t now_mono_ns, struct alarm_counts *out);

/* --- from before --- */
/* As a journal kept it: nothing is told of it but the tag's gravest. What this plant's mode does not know is dropped. */
void alarms_restore(struct alarms *alarms, int index, const struct alarm *saved, struct instant now);
/* Takes over alarms of the same tag and kind from those of an earlier plant, with delays that run and all. */
void alarms_adopt(struct alarms *alarms, const struct alarms *before);

#endif
