/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What alarms.c and alarms_kept.c share. Private to them. */
#ifndef ALARM_ALARMS_IMPL_H
#define ALARM_ALARMS_IMPL_H
#include "alarm/alarms.h"
#include "alarm/devices.h"

enum feed_role { FEED_VALUE, FEED_BIT, FEED_BADNESS, FEED_ACKNOWLEDGED, FEED_SUPPRESSES };
struct feed { /* a tag whose samples an alarm depends on, and their meaning for it */
    int tag, alarm;
    enum feed_role role;
};

struct last_sample { /* the last sample of a tag */
    double value;
    bool sampled, bad;
};

struct gravest { /* the alarm that is shown for a tag, and its state */
    uint8_t kind, status;
};

struct alarms {
    const struct plant *plant;
    struct alarms_listener listener;
    struct alarm *list;
    size_t count, capacity;
    struct feed *feeds; /* by tag */
    size_t feed_count, feed_capacity;
    int *by_tag;        /* indices of alarms, by tag */
    int *first_feed, *first_alarm; /* by tag, and one more: in feeds, by_tag */
    struct last_sample *seen;
    struct devices *devices;
    struct sample_event *noticed; /* room for what alarms_tick finds out; by tag */
    struct gravest *gravest;
    int *timed;         /* alarms with a running delay, and shelved ones */
    size_t timed_count, timed_capacity;
    int carried;        /* how many alarms are suppressed by that of their device */
    uint64_t number;
    int newest;
    int64_t begun_ns;   /* monotonic, of the first tick */
};

void alarms_touch(struct alarms *alarms, int index); /* gives the alarm the number of a new change */
void alarms_watch(struct alarms *alarms, int index); /* adds the alarm to timed, if time can change it */

#endif
