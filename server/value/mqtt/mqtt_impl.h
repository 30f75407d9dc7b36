/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An MQTT source, as its files share it: one thread with one connection. Private to value/mqtt/. Thread: the source's own. */
#ifndef VALUE_MQTT_IMPL_H
#define VALUE_MQTT_IMPL_H
#include "base/log/log_pace.h"
#include "value/backoff.h"
#include "value/mqtt/mqtt_client.h"
#include "value/mqtt/mqtt_payload.h"
#include "value/mqtt/mqtt_topics.h"
#include "value/mqtt/sparkplug.h"
#include "value/source_impl.h"
#include "value/stamped_writer.h"

struct mqtt_source {
    struct source base;
    counter *messages_ok, *messages_refused, *samples, *connects, *up, *host, *gaps, *historical, *rebirths;
    char *client_id;
    /* --- below: used by the source's thread only */
    struct mqtt_topics topics;
    struct stamped_writer writer;
    struct sparkplug *sparkplug; /* NULL: other payloads */
    char **subscriptions;
    size_t subscription_count;
    struct mqtt_client *client;
    struct host_turn turn;
    bool link_up, link_known;
    bool subscribed;             /* what comes now was published now, unless it says otherwise */
    struct log_pace refusals;    /* of messages */
    char last_refused[300];      /* topic and reason of the last one, for the log */
    struct log_pace absences;    /* messages without the value of a tag that was in none yet */
    bool *matched;               /* by index in plant->tags: a JSON message has held its value */
    int64_t skew_said_ns[2];     /* when clocks that are behind, ahead were last logged */
};

/* Handles a message for the source's tags: refuses it, with words in the log, or writes its values. */
void mqtt_take_message(struct mqtt_source *mqtt, const struct mqtt_message *message);
/* Counts a message that is refused, and logs one line a minute at most. */
void mqtt_refuse(struct mqtt_source *mqtt, const struct mqtt_message *message, const char *why);
/* Logs how many messages were left out of the log, once a minute has gone by. */
void mqtt_log_left_out(struct mqtt_source *mqtt, int64_t now_ns);

#endif
