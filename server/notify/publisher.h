/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Publishes readings and alarms to an MQTT broker, as the plant file's `publish` says, on a thread of its own. The newest wins: what a slow
   broker has not taken yet is not queued behind. Nothing else waits for it. */
#ifndef NOTIFY_PUBLISHER_H
#define NOTIFY_PUBLISHER_H
#include "alarm/alarm_service.h"

struct publisher_params {
    struct log *log;
    struct counters *counters;
    const struct plant *plant;           /* with a `publish` */
    struct store *store;
    struct alarm_service *alarm_service; /* all three outlive the publisher */
};

struct publisher;
/* Returns NULL if there is no thread (logged). */
struct publisher *publisher_start(const struct publisher_params *params);
/* Ends the connection; the broker says "offline" for us. &NULL is fine; leaves NULL. */
void publisher_stop(struct publisher **publisher);

#endif
