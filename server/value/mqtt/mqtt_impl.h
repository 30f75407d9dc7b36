/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of an MQTT source, which has one thread with one connection. Private to value/mqtt/. Call only in the source's own thread. */
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
    /* --- below: members that only the source's thread uses */
    struct mqtt_topics topics;
    struct stamped_writer writer;
    struct sparkplug *sparkplug; /* decoder of Sparkplug messages; NULL: the source's messages have another form */
    char **subscriptions;
    size_t subscription_count;
    struct mqtt_client *client;
    struct host_turn turn;
    int addresses[PLANT_HOSTS]; /* by host: which of its IP addresses to use, see mqtt_client_next_address() */
    bool link_up, link_known;
    bool subscribed;          /* true: all topics are subscribed, so a message without the retained flag has a new value */
    struct log_pace refusals; /* rate limit of the log line about refused messages */
    char last_refused[300];   /* topic of the last refused message and the reason of its refusal, for the next log line */
    /* rate limit of the log line about a tag whose value no message has contained yet */
    struct log_pace absences;
    bool *matched; /* by index in plant->tags: true once a JSON message has contained this tag's value */
    /* monotonic times of the last log lines about wrong clocks of publishers: [0] a clock behind ours, [1] a clock ahead of ours */
    int64_t skew_said_ns[2];
};

/* Writes the values in a message to the tags of its topic, or refuses the message and logs the reason. */
void mqtt_take_message(struct mqtt_source *mqtt, const struct mqtt_message *message);
/* Counts a refused message. Logs at most one refused message per minute. */
void mqtt_refuse(struct mqtt_source *mqtt, const struct mqtt_message *message, const char *why);
/* Logs, at most once a minute, how many refused messages mqtt_refuse() has not logged. */
void mqtt_log_left_out(struct mqtt_source *mqtt, int64_t now_ns);

#endif
