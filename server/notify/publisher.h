/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Publishes readings and alarms to an MQTT broker, as configured by the plant file's `publish`, on a thread of its own. There
   is no queue: a slow broker gets only the newest readings. No other thread waits for this thread. */
#ifndef NOTIFY_PUBLISHER_H
#define NOTIFY_PUBLISHER_H
#include "alarm/alarm_service.h"

struct publisher_params {
    struct log *log;
    struct counters *counters;
    const struct plant *plant; /* plant to publish; its plant file must have the key `publish` */
    struct store *store;
    struct alarm_service *alarm_service; /* plant, store of readings and alarm service must outlive the publisher */
};

struct publisher;
/* Starts a publisher and its thread. Returns NULL if the thread cannot be started (logged). */
struct publisher *publisher_start(const struct publisher_params *params);
/* Ends the connection; the broker then publishes our last will, "offline". Accepts a pointer to NULL; sets *publisher to NULL. */
void publisher_stop(struct publisher **publisher);

#endif
