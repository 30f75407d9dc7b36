/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What alarms.c and alarms_kept.c share. Private to them. */
#ifndef ALARM_ALARMS_IMPL_H
#define ALARM_ALARMS_IMPL_H
#include "alarm/alarms.h"
#include "alarm/devices.h"

enum feed_role { FEED_VALUE, FEED_BIT, FEED_BADNESS, FEED_ACKNOWLEDGED, FEED_SUPPRESSES };
struct feed { /* which samples an alarm hears, and as what */
    int tag, alarm;
    enum feed_role role;
};

struct seen { /* of a tag */
    double value;
    bool sampled, bad;
};

struct gravest {
    uint8_t kind, status;
};

struct alarms {
    const struct plant *plant;
    struct alarms_listener listener;
    struct alarm *list;
    size_t count, capacity;
    struct feed *feeds; /* by tag */
    size_t feed_count, feed_capacity;
    int *by_tag;                   /* indices of alarms, by tag */
    int *first_feed, *first_alarm; /* by tag, and one more: in feeds, by_tag */
    struct seen *seen;
    struct devices *devices;
    struct sample_event *noticed; /* room for what alarms_tick finds out; by tag */
    struct gravest *gravest;
    int *timed; /* alarms with a delay or a shelf that runs */
    size_t timed_count, timed_capacity;
    int carried; /* alarms that those of their devices stand for */
    uint64_t number;
    int newest;
    int64_t begun_ns; /* monotonic, of the first tick */
};

void alarms_touch(struct alarms *alarms, int index);
void alarms_watch(struct alarms *alarms, int index); /* in timed, if time can change it */

#endif
