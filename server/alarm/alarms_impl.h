/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Definitions that alarms.c and alarms_restore.c share. Private to them. */
#ifndef ALARM_ALARMS_IMPL_H
#define ALARM_ALARMS_IMPL_H
#include "alarm/alarms.h"
#include "alarm/devices.h"

enum feed_role { FEED_VALUE, FEED_BIT, FEED_BADNESS, FEED_ACKNOWLEDGED, FEED_SUPPRESSES };
/* one dependency of an alarm on the samples of a tag; the role says whether it uses the tag's value, alarm bit or quality, for
   example */
struct feed {
    int tag, alarm;
    enum feed_role role;
};

struct last_sample { /* newest sample of a tag */
    double value;
    bool sampled, bad;
    bool recheck; /* true: a reload may have changed the tag's alarms, so they must be evaluated again with the present reading */
    /* monotonic time since when the tag has been Bad and waiting for a first reading; 0: it is not waiting */
    int64_t waits_since_ns;
};

struct gravest { /* most urgent alarm of a tag: its kind and its state */
    uint8_t kind, status;
};

struct alarms {
    const struct plant *plant;
    struct alarms_listener listener;
    struct alarm *list;
    size_t count, capacity;
    struct feed *feeds; /* dependencies of alarms on the samples of tags, sorted by tag */
    size_t feed_count, feed_capacity;
    int *by_tag; /* [position]: index in `list`; contains all alarms, sorted by tag */
    /* [tag], with one extra element at the end: position of the tag's first entry in `feeds` and in by_tag */
    int *first_feed, *first_alarm;
    struct last_sample *seen;
    struct devices *devices;
    struct sample_event *noticed; /* scratch buffer of alarms_tick(): the sample events that it creates, at most one per tag */
    struct gravest *gravest;
    int *timed; /* indices of the alarms that time alone can change: those with a running delay and shelved ones */
    size_t timed_count, timed_capacity;
    int carried; /* number of BAD alarms that are suppressed because the LINK alarm of their device reports the failure */
    uint64_t number;
    int newest;
};

void alarms_touch(struct alarms *alarms, int index); /* gives the alarm the next change number, because its state has changed */
void alarms_watch(struct alarms *alarms, int index); /* adds the alarm to `timed` if it can change by the passing of time alone */

#endif
